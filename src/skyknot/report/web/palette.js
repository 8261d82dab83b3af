// Colours of the replay by theme, and the scale from slow to fast.

const PALETTES = {
  light: {
    zenith: "#6fa6dc", horizon: "#f1f5f8", ground: "#e3e8e6", grid: "#9aa9a8", ink: "#1c2733",
    muted: "#5b6b7a", building: "#ccd6e0", roof: "#f2f5f8", edge: "#7d8c9a", glass: "#56b4e9",
    sun: 1.9, sky: 1.9, shadow: 0.22, front: "#e69f00", rear: "#0072b2", goal: "#d55e00",
  },
  dark: {
    zenith: "#070d15", horizon: "#243445", ground: "#18212a", grid: "#4a5b6b", ink: "#e8edf2",
    muted: "#9fb0bf", building: "#3d4c5b", roof: "#4b5d6e", edge: "#8b9cad", glass: "#56b4e9",
    sun: 1.7, sky: 1.6, shadow: 0.45, front: "#f0b030", rear: "#4aa8e8", goal: "#f4803a",
  },
};

/** The colour at a share (0 … 1) of a list of colours. */
function shade(colors, share) {
  const place = Math.min(Math.max(share, 0), 1) * (colors.length - 1);
  const i = Math.min(Math.floor(place), colors.length - 2);
  return new THREE.Color(colors[i]).lerp(new THREE.Color(colors[i + 1]), place - i);
}

/** A round number near a size: 1, 2 or 5 times a power of ten, not above it. */
function roundSize(size) {
  const power = 10 ** Math.floor(Math.log10(size));
  return power * [5, 2, 1].find((digit) => digit * power <= size * (1 + 1e-9));
}
