"""The flight as a moving picture: ground and obstacles once, craft and path in every frame.

Legend: F frames, M points of the path; pixels are those of the file.

What does not move is drawn once and kept; a frame puts a few artists over it, so that a film of
some hundred frames takes seconds. A GIF has one palette for all frames: colours do not flicker.
"""

from __future__ import annotations

import io
import subprocess
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.animation import FFMpegWriter
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import Normalize, to_rgb
from matplotlib.figure import Figure
from numpy.typing import NDArray
from PIL import Image

from skyknot.errors import UserError
from skyknot.report import style
from skyknot.report.craft import attitude, craft_shape, span
from skyknot.report.figures import write_bytes
from skyknot.report.obstacles import draw_shadows, draw_sheets, draw_solid
from skyknot.report.reading import Reading
from skyknot.report.scene import Scene
from skyknot.report.stage import draw_ground
from skyknot.report.style import styled
from skyknot.solution import Solution

Array = NDArray[np.float64]
Pixels = NDArray[np.uint8]

FILMS = ("gif", "mp4")
"""Formats of films; MP4 needs the program ffmpeg."""

PER_SECOND = {"gif": 15, "mp4": 30}
"""Frames per second."""

LONGEST, STILL_AT_END = 12.0, 1.0
"""Seconds that a film takes at most; longer flights are shown faster. Then it stands still."""

WIDTH, DPI = 7.0, 110
"""Inches, and pixels in each."""

CRAFT_SHARE = 0.09
"""Span of the drawn craft as a share of the picture's width."""

NEARLY_WHITE = 248

STILL = 1e-3
"""Speed, m/s, below which nothing moves."""

Tell = Callable[[int, int], None]


def best_film() -> str:
    """Return "mp4" where the program ffmpeg is installed, else "gif"."""
    return "mp4" if FFMpegWriter.isAvailable() else "gif"


def animated(solution: Solution, file_format: str = "gif", tell: Tell | None = None) -> bytes:
    """Return a film of the flight.

    Parameters
    ----------
    solution : of a vehicle with a position
    file_format : "gif", or "mp4" where ffmpeg is installed
    tell : called after every frame with its number, from 1, and how many there are

    Raises
    ------
    UserError
        When nothing flies in this solution, or the format cannot be made.
    """
    reading = Reading(solution)
    _check(reading, file_format)
    with styled():
        film = _Film(Scene(reading))
        frames = film.frames(PER_SECOND[file_format], tell)
        return _gif(frames) if file_format == "gif" else _mp4(frames)


def write_film(solution: Solution, path: Path) -> Path:
    """Write a film in the format of the path's ending; raises as ``animated``."""
    write_bytes(path, animated(solution, path.suffix.lower().removeprefix(".")))
    return path


class _Film:
    """One figure whose moving artists are set to a time."""

    def __init__(self, scene: Scene) -> None:
        self.scene, self.vehicle = scene, scene.reading.vehicle
        self.factor = _enlarged(scene)
        self.points = scene.stage.camera.project(scene.path)
        self.hidden = scene.hidden(scene.path)
        self.canvas, self.axes = _backdrop(scene)
        self._add_artists()

    def frames(self, rate: int, tell: Tell | None) -> Iterator[Pixels]:
        """Yield the pixels (height, width, 3) of every frame."""
        self.canvas.draw()
        still = self.canvas.copy_from_bbox(self.axes.figure.bbox)
        moments = self.moments(rate)
        for i, (time, faster) in enumerate(moments, start=1):
            self.canvas.restore_region(still)
            self.show(time, faster)
            for artist in self.moving:
                self.axes.draw_artist(artist)
            yield np.asarray(self.canvas.buffer_rgba())[:, :, :3].copy()
            if tell is not None:
                tell(i, len(moments))

    def moments(self, rate: int) -> list[tuple[float, float]]:
        """Return the time of every frame, s, and how many times faster than life it passes."""
        start, end = self.scene.times[0], self.scene.times[-1]
        faster = max(1.0, (end - start) / LONGEST)
        count = max(2, round((end - start) / faster * rate))
        times = [*np.linspace(start, end, count), *[end] * round(STILL_AT_END * rate)]
        return [(float(time), float(faster)) for time in times]

    def show(self, time: float, faster: float) -> None:
        """Set everything that moves."""
        scene, camera = self.scene, self.scene.stage.camera
        state = scene.reading.trajectory.state(time)[None]
        place = scene.place(state)[0]
        done = int(np.searchsorted(scene.times, time))
        line = np.concatenate([self.points[:done], camera.project(place)[None]])
        pieces = np.stack([line[:-1], line[1:]], axis=1)
        for artist, seen in ((self.front, ~self.hidden), (self.behind, self.hidden)):
            artist.set_segments(list(pieces[seen[:done]]))
            artist.set_array(scene.speed[:done][seen[:done]])
        dim = 0.35 if scene.hidden(place[None])[0] else 1.0
        self._place_craft(place, attitude(scene.reading, state)[0], dim)
        foot = np.array([*place[:2], scene.stage.floor])
        self.drop.set_segments([camera.project(np.stack([foot, place]))])
        self.words.set_text(self._words(time, state, place, faster))

    def _words(self, time: float, state: Array, place: Array, faster: float) -> str:
        parts = [f"{time - self.scene.times[0]:5.1f} s", f"altitude {place[2]:.1f} m"]
        if self.scene.reading.has("vx", "vy", "vz"):
            velocity = self.scene.reading.columns(state, "vx", "vy", "vz")
            parts.insert(1, f"{float(np.linalg.norm(velocity)):.1f} m/s")
        if faster > 1.05:
            parts.append(f"{faster:.2g} times as fast")
        return "   ".join(parts)

    def _place_craft(self, place: Array, angles: Array, dim: float) -> None:
        camera = self.scene.stage.camera
        shape = craft_shape(self.vehicle, angles, self.factor)

        def placed(offsets: Array) -> Array:
            return camera.project(place + camera.unstretched(offsets))

        far_first = np.argsort(camera.depth(shape.discs.mean(axis=1)))
        colors = [style.ORANGE if shape.front[i] else style.BLUE for i in far_first]
        discs = [placed(shape.discs[i]) for i in far_first]
        self.arms.set_segments([placed(arm) for arm in shape.arms])
        self.hull.set_verts([placed(shape.hull)])
        self.discs.set_verts(discs)
        self.discs.set_facecolor([(color, 0.4 * dim) for color in colors])
        self.discs.set_edgecolor([(color, dim) for color in colors])
        self.arms.set_alpha(dim)
        self.hull.set_alpha(dim)

    def _add_artists(self) -> None:
        axes, fastest = self.axes, float(self.scene.speed.max())
        look: dict[str, Any] = {"cmap": style.SPEED, "norm": Normalize(0, max(fastest, 1e-9))}
        self.drop = LineCollection([], colors=style.MUTED, linewidths=0.9, linestyles=(0, (2, 2)))
        self.behind = LineCollection([], linewidths=1.8, alpha=0.45, capstyle="round", **look)
        self.front = LineCollection([], linewidths=3.0, capstyle="round", **look)
        self.arms = LineCollection([], colors=style.INK, linewidths=1.4)
        self.hull = PolyCollection([], facecolors=style.INK, linewidths=0)
        self.discs = PolyCollection([], linewidths=1.1)
        lines = (self.drop, self.behind, self.front, self.arms, self.hull, self.discs)
        for artist in lines:
            axes.add_collection(artist, autolim=False)
        self.words = axes.text(
            0.012, 0.985, "", transform=axes.transAxes, ha="left", va="top", fontsize=11,
            color=style.INK, family="DejaVu Sans Mono",
        )  # fmt: skip
        self.moving = (*lines, self.words)
        for artist in self.moving:
            artist.set_animated(True)


def _backdrop(scene: Scene) -> tuple[Any, Any]:
    """Return canvas and axes with all that does not move."""
    figure = Figure(figsize=(WIDTH, WIDTH), dpi=DPI)
    canvas = FigureCanvasAgg(figure)
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set_axis_off()
    draw_ground(axes, scene.stage)
    draw_shadows(axes, scene)
    for solid in scene.bodies:
        draw_solid(axes, scene, solid)
    draw_sheets(axes, scene)
    points = scene.stage.camera.project(scene.path)
    axes.plot(*points.T, color=style.MUTED, linewidth=0.8, linestyle=(0, (1, 2.5)), alpha=0.7)
    if scene.goal is not None:
        goal = scene.stage.camera.project(scene.goal)
        axes.plot(*goal, "D", color=style.VERMILLION, markersize=4)
    for order, artist in enumerate([*axes.get_children()]):
        artist.set_zorder(order)
    axes.text(
        0.985, 0.015, _legend(scene), transform=axes.transAxes, ha="right", va="bottom",
        fontsize=8, color=style.MUTED,
    )  # fmt: skip
    low, high = _view(axes, scene)
    axes.set_xlim(low[0], high[0])
    axes.set_ylim(low[1], high[1])
    rows = 2 * round(0.5 * WIDTH * DPI * float((high[1] - low[1]) / (high[0] - low[0])))
    figure.set_size_inches(WIDTH, rows / DPI)
    return canvas, axes


def _legend(scene: Scene) -> str:
    """Return every liberty that the film takes, in one line."""
    parts, factor, fastest = [], _enlarged(scene), float(scene.speed.max())
    if fastest > STILL:
        parts.append(f"colour: speed, 0 to {fastest:.2g} m/s")
    if factor > 1:
        parts.append(f"craft {factor:.0f} times its size")
    if scene.stage.camera.stretch > 1:
        parts.append(f"heights stretched {scene.stage.camera.stretch:.2g} times")
    return "; ".join(parts)


def _enlarged(scene: Scene) -> float:
    """Return how much larger than life the craft is drawn, a whole number."""
    share = CRAFT_SHARE * scene.stage.width / span(scene.reading.vehicle)
    return float(max(1, round(share)))


def _view(axes: Any, scene: Scene) -> tuple[Array, Array]:
    """Return the corners of what is to be seen, with room for words and craft."""
    room = 0.06 * scene.stage.width
    box = axes.dataLim.get_points()
    inside = [text for text in axes.texts if text.get_transform() == axes.transData]
    places = [text.get_position() for text in inside] or [tuple(box[0])]
    low = np.minimum(box[0], np.min(places, axis=0)) - np.array([0.6, 0.9]) * room
    high = np.maximum(box[1], np.max(places, axis=0)) + np.array([0.6, 1.5]) * room
    return low, high


def _gif(frames: Iterator[Pixels]) -> bytes:
    """Return an endless GIF."""
    images = [Image.fromarray(frame) for frame in frames]
    palette = _palette(images[-1])
    flat = [image.quantize(palette=palette, dither=Image.Dither.NONE) for image in images]
    stream = io.BytesIO()
    lasts = round(1000 / PER_SECOND["gif"])
    flat[0].save(
        stream, "GIF", save_all=True, append_images=flat[1:], duration=lasts, loop=0, optimize=False
    )
    return stream.getvalue()


def _palette(image: Image.Image) -> Image.Image:
    """Return an image with the colours of a frame and those of path, craft and words."""
    shades = [style.SPEED(share)[:3] for share in np.linspace(0, 1, 32)]
    shades += [to_rgb(name) for name in (style.ORANGE, style.BLUE, style.VERMILLION, style.INK)]
    swatches = np.repeat(np.repeat(np.array(shades)[None], 24, axis=0), 12, axis=1)
    strip = Image.fromarray((255 * swatches).astype(np.uint8))
    both = Image.new("RGB", (max(image.width, strip.width), image.height + strip.height))
    both.paste(image, (0, 0))
    both.paste(strip, (0, image.height))
    palette = both.quantize(256, method=Image.Quantize.MEDIANCUT)
    colors = np.array(palette.getpalette()).reshape(-1, 3)
    colors[colors.min(axis=1) >= NEARLY_WHITE] = 255  # paper stays white
    palette.putpalette(colors.astype(np.uint8).tobytes())
    return palette


def _mp4(frames: Iterator[Pixels]) -> bytes:
    """Return a film in H.264, by ffmpeg."""
    first = next(frames)
    size, rate = f"{first.shape[1]}x{first.shape[0]}", str(PER_SECOND["mp4"])
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "film.mp4"
        words = [str(mpl.rcParams["animation.ffmpeg_path"]), "-loglevel", "error"]
        words += ["-f", "rawvideo", "-pix_fmt", "rgb24", "-s", size, "-r", rate, "-i", "-"]
        words += ["-c:v", "libx264", "-crf", "20", "-pix_fmt", "yuv420p", str(path)]
        with subprocess.Popen(words, stdin=subprocess.PIPE, stderr=subprocess.PIPE) as process:
            complaint = _fed(process, first, frames)
        if process.returncode != 0:
            raise UserError(
                "ffmpeg could not make the film.",
                where=words[0],
                found=complaint.strip() or f"exit status {process.returncode}",
                expected="an ffmpeg with the encoder libx264",
                do="Choose gif, or install such an ffmpeg.",
            )
        return path.read_bytes()


def _fed(process: subprocess.Popen[bytes], first: Pixels, frames: Iterator[Pixels]) -> str:
    """Give a process the frames until it has them all or leaves; return its complaints."""
    assert process.stdin is not None
    assert process.stderr is not None
    try:
        process.stdin.write(first.tobytes())
        for frame in frames:
            process.stdin.write(frame.tobytes())
        process.stdin.close()
    except BrokenPipeError:
        pass  # it has said why on standard error
    return process.stderr.read().decode("utf-8", "replace")


def _check(reading: Reading, file_format: str) -> None:
    if not reading.flies:
        raise UserError(
            "There is no flight to animate in this solution.",
            where="solution",
            found="no vehicle with states x, y, z",
            expected="the flight of a vehicle",
            do="Animate a run folder, or a solution that carries its problem with a vehicle.",
        )
    if file_format not in FILMS or (file_format == "mp4" and not FFMpegWriter.isAvailable()):
        raise UserError(
            "The film cannot be made in this format.",
            where="format",
            found=f"{file_format!r}" + (", and no ffmpeg" if file_format == "mp4" else ""),
            expected="gif, or mp4 where the program ffmpeg is installed",
            do="Choose gif, or install ffmpeg.",
        )
