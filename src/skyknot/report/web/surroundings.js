// Sky, ground with its grid, buildings, corridors, sheets, wind: all that does not move.
// East, north, up; metres.

const STOREY = 3;
const MOST_STOREYS = 80;

function surroundings(data, palette) {
  const world = new THREE.Group();
  const low = new THREE.Vector3(...data.stage.low);
  const high = new THREE.Vector3(...data.stage.high);
  const size = low.distanceTo(high);
  world.add(sky(palette, size), ...ground(data, palette, low, high, size));
  for (const body of data.bodies) world.add(solid(body, palette));
  for (const corners of data.sheets) world.add(sheet(corners, palette));
  world.add(...lights(palette, low, high, size, data.azimuth - 0.8));
  world.add(compass(palette, low, high));
  if (data.wind) world.add(windArrow(data.wind, palette, low, high));
  return world;
}

function sky(palette, size) {
  const material = new THREE.ShaderMaterial({
    side: THREE.BackSide, depthWrite: false, fog: false,
    uniforms: {
      zenith: { value: new THREE.Color(palette.zenith) },
      horizon: { value: new THREE.Color(palette.horizon) },
    },
    vertexShader: `varying vec3 way;
      void main() {
        way = position;
        gl_Position = projectionMatrix * mat4(mat3(modelViewMatrix)) * vec4(position, 1.0);
        gl_Position.z = gl_Position.w * 0.999999;
      }`,
    fragmentShader: `varying vec3 way; uniform vec3 zenith; uniform vec3 horizon;
      void main() {
        float height = normalize(way).z;
        gl_FragColor = vec4(mix(horizon, zenith, smoothstep(0.0, 0.4, height)), 1.0);
        #include <colorspace_fragment>
      }`,
  });
  const dome = new THREE.Mesh(new THREE.SphereGeometry(size, 32, 16), material);
  dome.frustumCulled = false;
  dome.renderOrder = -2;
  return dome;
}

function gridSpacing(low, high) {
  return roundSize(Math.max(high.x - low.x, high.y - low.y) / 6);
}

function ground(data, palette, low, high, size) {
  const middle = low.clone().add(high).multiplyScalar(0.5);
  const disc = new THREE.Mesh(
    new THREE.CircleGeometry(14 * size, 96),
    new THREE.MeshBasicMaterial({ color: palette.ground, polygonOffset: true, polygonOffsetUnits: 4, polygonOffsetFactor: 4 }),
  );
  disc.position.set(middle.x, middle.y, low.z);
  const dark = new THREE.Mesh(
    new THREE.PlaneGeometry(3 * size, 3 * size),
    new THREE.ShadowMaterial({ opacity: palette.shadow, depthWrite: false, polygonOffset: true, polygonOffsetUnits: 2, polygonOffsetFactor: 2 }),
  );
  dark.position.copy(disc.position);
  dark.receiveShadow = true;
  return [disc, dark, grid(palette, low, high, middle, size)];
}

function grid(palette, low, high, middle, size) {
  const material = new THREE.ShaderMaterial({
    transparent: true, depthWrite: false,
    uniforms: {
      color: { value: new THREE.Color(palette.grid) },
      spacing: { value: gridSpacing(low, high) },
      middle: { value: new THREE.Vector2(middle.x, middle.y) },
      reach: { value: 1.1 * size },
    },
    vertexShader: `varying vec2 place;
      void main() {
        vec4 world = modelMatrix * vec4(position, 1.0);
        place = world.xy;
        gl_Position = projectionMatrix * viewMatrix * world;
      }`,
    fragmentShader: `varying vec2 place;
      uniform vec3 color; uniform float spacing; uniform vec2 middle; uniform float reach;
      float lines(float step, float width) {
        vec2 cell = place / step, away = abs(fract(cell - 0.5) - 0.5) / max(fwidth(cell), vec2(1e-6));
        float crowd = max(fwidth(cell).x, fwidth(cell).y);
        return (1.0 - clamp(min(away.x, away.y) - width, 0.0, 1.0)) * (1.0 - smoothstep(0.15, 0.5, crowd));
      }
      void main() {
        float fade = 1.0 - smoothstep(0.35, 1.0, length(place - middle) / reach);
        float strength = max(0.75 * lines(spacing, 0.1), 0.28 * lines(spacing / 5.0, 0.0));
        gl_FragColor = vec4(color, strength * fade);
        #include <colorspace_fragment>
      }`,
  });
  const plane = new THREE.Mesh(new THREE.PlaneGeometry(2.4 * size, 2.4 * size), material);
  plane.position.set(middle.x, middle.y, low.z);
  plane.renderOrder = 1;
  return plane;
}

function solid(body, palette) {
  if (body.kind === "tube") return tube(body, palette);
  const group = new THREE.Group();
  const geometry = {
    box: () => new THREE.BoxGeometry(...body.size),
    cylinder: () => new THREE.CylinderGeometry(body.radius, body.radius, body.height, 64).rotateX(Math.PI / 2),
    ellipsoid: () => new THREE.SphereGeometry(1, 48, 32).scale(...(body.axes ?? [1, 1, 1])),
  }[body.kind]();
  const wall = new THREE.MeshLambertMaterial({ color: palette.building });
  const roof = new THREE.MeshLambertMaterial({ color: palette.roof });
  // Groups of a box: ±x, ±y, ±z, here z down; of a cylinder: side, top, bottom.
  const coats = { box: [wall, wall, wall, wall, roof, roof], cylinder: [wall, roof, roof] };
  const mesh = new THREE.Mesh(geometry, coats[body.kind] ?? wall);
  mesh.castShadow = mesh.receiveShadow = true;
  const outline = new THREE.LineSegments(
    new THREE.EdgesGeometry(geometry, 30),
    new THREE.LineBasicMaterial({ color: palette.edge }),
  );
  group.add(mesh, outline);
  if (body.kind === "box") group.add(storeys(body, palette));
  group.position.set(...body.center);
  if (body.turn) group.quaternion.copy(quaternion(body.turn));
  group.userData.top = body.kind === "ellipsoid" ? body.axes[2] : 0.5 * (body.height ?? body.size[2]);
  return group;
}

/** A thin line at every storey of a box, for scale. */
function storeys(body, palette) {
  const [x, y, height] = body.size;
  const points = [];
  if (height > STOREY && height < MOST_STOREYS * STOREY) {
    for (let level = STOREY; level < height; level += STOREY) {
      const ring = [[-x, -y], [x, -y], [x, y], [-x, y]].map(([a, b]) => [a / 2, b / 2, height / 2 - level]);
      ring.forEach((corner, i) => points.push(...corner, ...ring[(i + 1) % 4]));
    }
  }
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.Float32BufferAttribute(points, 3));
  return new THREE.LineSegments(
    geometry,
    new THREE.LineBasicMaterial({ color: palette.edge, transparent: true, opacity: 0.3 }),
  );
}

function tube(body, palette) {
  const group = new THREE.Group();
  const glass = new THREE.MeshBasicMaterial({
    color: palette.glass, transparent: true, opacity: 0.07, depthWrite: false, side: THREE.DoubleSide,
  });
  const line = new THREE.LineBasicMaterial({ color: palette.glass, transparent: true, opacity: 0.55 });
  for (let i = 0; i + 1 < body.points.length; i++) {
    const a = new THREE.Vector3(...body.points[i]), b = new THREE.Vector3(...body.points[i + 1]);
    const length = a.distanceTo(b);
    const along = b.clone().sub(a).normalize();
    const turn = new THREE.Quaternion().setFromUnitVectors(new THREE.Vector3(0, 1, 0), along);
    const wall = new THREE.Mesh(new THREE.CylinderGeometry(body.radius, body.radius, length, 48, 1, true), glass);
    wall.position.copy(a).lerp(b, 0.5);
    wall.quaternion.copy(turn);
    group.add(wall);
    const count = Math.max(1, Math.round(length / (2.5 * body.radius)));
    for (let k = 0; k <= count; k++) group.add(hoop(a.clone().lerp(b, k / count), along, body.radius, line));
  }
  return group;
}

function hoop(center, along, radius, material) {
  const points = [];
  for (let k = 0; k <= 64; k++) {
    const angle = (2 * Math.PI * k) / 64;
    points.push(new THREE.Vector3(radius * Math.cos(angle), radius * Math.sin(angle), 0));
  }
  const ring = new THREE.Line(new THREE.BufferGeometry().setFromPoints(points), material);
  ring.position.copy(center);
  ring.quaternion.setFromUnitVectors(new THREE.Vector3(0, 0, 1), along);
  return ring;
}

function sheet(corners, palette) {
  const group = new THREE.Group();
  const points = corners.map((corner) => new THREE.Vector3(...corner));
  const fan = [];
  for (let i = 1; i + 1 < points.length; i++) fan.push(points[0], points[i], points[i + 1]);
  const glass = new THREE.MeshBasicMaterial({
    color: palette.glass, transparent: true, opacity: 0.035, depthWrite: false, side: THREE.DoubleSide,
  });
  const border = new THREE.Line(
    new THREE.BufferGeometry().setFromPoints([...points, points[0]]),
    new THREE.LineDashedMaterial({ color: palette.glass, transparent: true, opacity: 0.6, dashSize: 2, gapSize: 1.4, scale: 1 }),
  );
  const reach = points[0].distanceTo(points[Math.floor(points.length / 2)]);
  border.material.dashSize = 0.018 * reach;
  border.material.gapSize = 0.012 * reach;
  border.computeLineDistances();
  group.add(new THREE.Mesh(new THREE.BufferGeometry().setFromPoints(fan), glass), border);
  return group;
}

function lights(palette, low, high, size, from) {
  const soft = new THREE.HemisphereLight("#ffffff", palette.ground, palette.sky);
  soft.position.set(0, 0, 1);
  const sun = new THREE.DirectionalLight("#fff6e6", palette.sun);
  const middle = low.clone().add(high).multiplyScalar(0.5);
  sun.target.position.copy(middle);
  sun.position.copy(middle).add(new THREE.Vector3(0.75 * Math.cos(from), 0.75 * Math.sin(from), 0.85).multiplyScalar(size));
  sun.castShadow = true;
  sun.shadow.mapSize.set(2048, 2048);
  const reach = 0.62 * size;
  Object.assign(sun.shadow.camera, { left: -reach, right: reach, bottom: -reach, top: reach, near: 0.05 * size, far: 2.6 * size });
  sun.shadow.bias = -4e-4;
  sun.shadow.normalBias = 2e-4 * size;
  return [soft, sun, sun.target];
}

/** An arrow to the north on the ground, at the south-west corner. */
function compass(palette, low, high) {
  const length = 0.5 * gridSpacing(low, high);
  const group = arrow(new THREE.Vector3(0, 1, 0), length, palette.muted);
  group.position.set(low.x, low.y, low.z + 0.01 * length);
  const name = label("N", palette.muted, palette.ground, 14);
  name.position.set(0, 1.35 * length, 0);
  group.add(name);
  return group;
}

function windArrow(wind, palette, low, high) {
  const way = new THREE.Vector3(...wind);
  const speed = way.length();
  const length = 0.9 * gridSpacing(low, high);
  const group = arrow(way.normalize(), length, palette.glass);
  group.position.set(low.x, 0.7 * low.y + 0.3 * high.y, low.z + 0.3 * (high.z - low.z));
  const name = label(`wind ${speed.toPrecision(2)} m/s`, palette.ink, palette.ground, 13);
  name.position.set(0, 0, 0.35 * length);
  group.add(name);
  return group;
}

function arrow(way, length, color) {
  const group = new THREE.Group();
  const material = new THREE.MeshBasicMaterial({ color });
  const shaft = new THREE.Mesh(new THREE.CylinderGeometry(0.025 * length, 0.025 * length, 0.8 * length, 12), material);
  shaft.position.y = 0.4 * length;
  const head = new THREE.Mesh(new THREE.ConeGeometry(0.09 * length, 0.28 * length, 20), material);
  head.position.y = 0.9 * length;
  const turned = new THREE.Group();
  turned.add(shaft, head);
  turned.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), way);
  group.add(turned);
  return group;
}

/** Words in space, always upright and of the same size on the screen. */
function label(text, color, halo, pixels = 12) {
  const scale = 3;
  const canvas = document.createElement("canvas");
  const pen = canvas.getContext("2d");
  const font = `600 ${pixels * scale}px system-ui, sans-serif`;
  pen.font = font;
  canvas.width = Math.ceil(pen.measureText(text).width) + 8 * scale;
  canvas.height = Math.ceil(1.5 * pixels * scale);
  pen.font = font;
  pen.textAlign = "center";
  pen.textBaseline = "middle";
  pen.lineJoin = "round";
  pen.lineWidth = 3 * scale;
  pen.strokeStyle = halo;
  pen.strokeText(text, canvas.width / 2, canvas.height / 2);
  pen.fillStyle = color;
  pen.fillText(text, canvas.width / 2, canvas.height / 2);
  const texture = new THREE.CanvasTexture(canvas);
  texture.colorSpace = "srgb";
  const sprite = new THREE.Sprite(new THREE.SpriteMaterial({
    map: texture, sizeAttenuation: false, depthWrite: false, transparent: true, fog: false,
  }));
  sprite.userData.pixels = [canvas.width / scale, canvas.height / scale];
  sprite.renderOrder = 10;
  sprite.center.set(0.5, 0);
  return sprite;
}

function quaternion([w, x, y, z]) {
  return new THREE.Quaternion(x, y, z, w);
}
