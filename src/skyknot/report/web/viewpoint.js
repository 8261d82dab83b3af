// Where the viewer stands: free around the scene, with the craft, behind it, or above all.

const VIEWS = { overview: "Overview", follow: "Follow the craft", chase: "Behind the craft", above: "From above" };

const ELEVATION = 0.37;

/** Points that an overview must show: the flights, and the corners of what stands around. */
function pointsOf(data) {
  const points = data.vehicles.flatMap(({ places, plan, span }) => {
    const along = [...places, ...plan].filter((_, i) => i % 8 === 0);
    return along.flatMap(([x, y, z]) => [[x, y, z - span], [x - span, y, z + span], [x + span, y, z + span]]);
  });
  for (const vehicle of data.vehicles) {
    points.push(...[vehicle.places[0], vehicle.places.at(-1)].map(([x, y]) => [x, y, data.stage.low[2]]));
  }
  for (const body of data.bodies) {
    if (body.kind === "tube") continue;
    const half = body.size ? body.size.map((size) => size / 2) : body.axes ?? [body.radius, body.radius, body.height / 2];
    const reach = body.size ? [Math.max(half[0], half[1]), Math.max(half[0], half[1]), half[2]] : half;
    for (let i = 0; i < 8; i++) points.push(body.center.map((c, j) => c + (i & (1 << j) ? reach[j] : -reach[j])));
  }
  return points.map((point) => new THREE.Vector3(...point));
}

class Viewpoint {
  constructor(canvas, data) {
    this.camera = new THREE.PerspectiveCamera(46, 1, 0.1, 1000);
    this.camera.up.set(0, 0, 1);
    this.controls = new THREE.OrbitControls(this.camera, canvas);
    this.controls.enableDamping = false;
    // A page must scroll past the picture: it zooms once chosen, and on touch turns sideways only.
    this.controls.enableZoom = false;
    canvas.style.touchAction = "pan-y";
    canvas.addEventListener("focus", () => { this.controls.enableZoom = true; });
    canvas.addEventListener("blur", () => { this.controls.enableZoom = false; });
    canvas.addEventListener("pointerdown", () => canvas.focus({ preventScroll: true }), true);
    this.controls.maxPolarAngle = 0.495 * Math.PI;
    this.low = new THREE.Vector3(...data.stage.low);
    this.high = new THREE.Vector3(...data.stage.high);
    this.size = this.low.distanceTo(this.high);
    this.azimuth = data.azimuth;
    this.points = pointsOf(data);
    this.view = "overview";
    this.heading = new THREE.Vector3(Math.cos(data.azimuth), Math.sin(data.azimuth), 0).negate();
    this.untouched = true;
    this.controls.addEventListener("start", () => { this.untouched = false; });
  }

  /** Fit the camera to a shape of the screen. */
  resize(width, height, craft) {
    this.camera.aspect = width / height;
    if (this.untouched) this.choose(this.view, craft);
    this.camera.updateProjectionMatrix();
  }

  choose(view, craft) {
    this.view = view;
    this.untouched = true;
    this.controls.enabled = view !== "chase";
    const near = 5 * craft.vehicle.span;
    if (view === "overview") this.fit(new THREE.Vector3(
      Math.cos(ELEVATION) * Math.cos(this.azimuth), Math.cos(ELEVATION) * Math.sin(this.azimuth), Math.sin(ELEVATION),
    ));
    if (view === "above") this.fit(new THREE.Vector3(0, -1e-3, 1).normalize());
    if (view === "follow") {
      this.controls.target.copy(craft.place);
      const side = new THREE.Vector3(Math.cos(this.azimuth), Math.sin(this.azimuth), 0.42).normalize();
      this.camera.position.copy(craft.place).addScaledVector(side, near);
    }
    if (view === "chase") this.behind(craft, 1);
    this.follow(craft, 0);
  }

  /** Stand in a direction, as near as shows all that there is, in the middle of the picture. */
  fit(way) {
    const right = new THREE.Vector3().crossVectors(new THREE.Vector3(0, 0, 1), way).normalize();
    const up = new THREE.Vector3().crossVectors(way, right);
    const tall = Math.tan(THREE.MathUtils.degToRad(this.camera.fov / 2)), wide = tall * this.camera.aspect;
    const target = this.low.clone().add(this.high).multiplyScalar(0.5);
    let away = 0;
    for (let round = 0; round < 6; round++) {
      const seen = this.points.map((point) => {
        const offset = point.clone().sub(target);
        return [offset.dot(right), offset.dot(up), offset.dot(way)];
      });
      away = Math.max(...seen.map(([x, y, depth]) => depth + Math.max(Math.abs(x) / wide, Math.abs(y) / tall)));
      const middle = (i) => {
        const places = seen.map((point) => point[i] / (away - point[2] + 1e-9));
        return 0.5 * (Math.max(...places) + Math.min(...places)) * away;
      };
      target.addScaledVector(right, middle(0)).addScaledVector(up, middle(1));
    }
    this.controls.target.copy(target);
    this.camera.position.copy(target).addScaledVector(way, 1.14 * away);
  }

  /** Keep up with the craft; `share` is how far to swing behind it at once. */
  follow(craft, seconds) {
    if (this.view === "follow") {
      const shift = craft.place.clone().sub(this.controls.target);
      this.camera.position.add(shift);
      this.controls.target.copy(craft.place);
    }
    if (this.view === "chase") this.behind(craft, 1 - Math.exp(-2.5 * seconds));
    else this.controls.update();
    const away = this.camera.position.distanceTo(craft.place);
    this.camera.near = Math.max(1e-3 * this.size, Math.min(0.05 * away, 0.02 * this.size));
    if (away < 0.05 * this.size) this.camera.near = 0.05 * away;
    this.camera.far = 30 * this.size;
    this.camera.updateProjectionMatrix();
  }

  behind(craft, share) {
    const flat = new THREE.Vector3(craft.velocity.x, craft.velocity.y, 0);
    if (flat.length() > 1e-3 * craft.vehicle.span) this.heading.lerp(flat.normalize(), share).normalize();
    const near = 4.2 * craft.vehicle.span;
    const aside = new THREE.Vector3(-this.heading.y, this.heading.x, 0);
    this.camera.position.copy(craft.place).addScaledVector(this.heading, -near).addScaledVector(aside, 0.42 * near);
    this.camera.position.z += 0.42 * near;
    this.controls.target.copy(craft.place);
    this.camera.lookAt(craft.place.clone().add(new THREE.Vector3(0, 0, 0.06 * near)));
  }
}
