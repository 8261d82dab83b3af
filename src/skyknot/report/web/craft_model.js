// A craft with its rotors, its trail, its plan and its goal.
// The craft is built in its own axes, forward, right, down, so that up is −z.

class Craft {
  constructor(vehicle, data, palette, alone) {
    this.vehicle = vehicle;
    this.alone = alone;
    this.palette = palette;
    this.colors = data.colors;
    this.floor = data.stage.low[2];
    this.group = new THREE.Group();
    this.body = new THREE.Group();
    this.rotors = vehicle.hubs.map((hub, i) => this.rotor(hub, i));
    this.body.add(...this.hull(), ...this.rotors.map((rotor) => rotor.group));
    this.group.add(this.body, ...this.lines());
    if (vehicle.goal) this.group.add(this.goal());
  }

  hull() {
    const reach = Math.max(...this.vehicle.hubs.map((hub) => Math.hypot(...hub)));
    const dark = new THREE.MeshLambertMaterial({ color: this.alone ? this.palette.ink : this.vehicle.color });
    const middle = new THREE.Mesh(new THREE.SphereGeometry(1, 32, 20).scale(0.36 * reach, 0.22 * reach, 0.13 * reach), dark);
    const nose = new THREE.Mesh(
      new THREE.ConeGeometry(0.1 * reach, 0.26 * reach, 24),
      new THREE.MeshLambertMaterial({ color: this.palette.front }),
    );
    nose.rotation.z = -Math.PI / 2;
    nose.position.x = 0.44 * reach;
    const arms = this.vehicle.hubs.map((hub) => {
      const end = new THREE.Vector3(...hub);
      const arm = new THREE.Mesh(new THREE.CylinderGeometry(0.028 * reach, 0.04 * reach, end.length(), 12), dark);
      arm.position.copy(end).multiplyScalar(0.5);
      arm.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), end.normalize());
      return arm;
    });
    const parts = [middle, nose, ...arms];
    for (const part of parts) part.castShadow = true;
    return parts;
  }

  rotor(hub, i) {
    const { radius } = this.vehicle;
    const color = hub[0] > 1e-9 ? this.palette.front : this.palette.rear;
    const group = new THREE.Group();
    group.position.set(hub[0], hub[1], hub[2] - 0.18 * radius);
    const disc = new THREE.Mesh(
      new THREE.CircleGeometry(radius, 48),
      new THREE.MeshBasicMaterial({ color, transparent: true, opacity: 0.28, side: THREE.DoubleSide, depthWrite: false }),
    );
    const rim = new THREE.Mesh(
      new THREE.TorusGeometry(radius, 0.022 * radius, 8, 64),
      new THREE.MeshBasicMaterial({ color }),
    );
    const blades = new THREE.Mesh(
      new THREE.BoxGeometry(1.92 * radius, 0.12 * radius, 0.02 * radius),
      new THREE.MeshBasicMaterial({ color: this.palette.ink, transparent: true, opacity: 0.55 }),
    );
    const motor = new THREE.Mesh(
      new THREE.CylinderGeometry(0.11 * radius, 0.13 * radius, 0.26 * radius, 20).rotateX(Math.PI / 2),
      new THREE.MeshLambertMaterial({ color: this.palette.ink }),
    );
    motor.position.z = 0.1 * radius;
    disc.castShadow = true;
    group.add(disc, rim, blades, motor);
    const jet = new THREE.Mesh(
      new THREE.CylinderGeometry(0.09 * radius, 0.09 * radius, 1, 16).rotateX(Math.PI / 2).translate(0, 0, -0.5),
      new THREE.MeshBasicMaterial({ color }),
    );
    jet.visible = this.vehicle.thrusts !== null;
    group.add(jet);
    return { group, blades, jet, spin: this.vehicle.spins[i], angle: i };
  }

  lines() {
    const { places, speeds, plan } = this.vehicle;
    const fastest = Math.max(...speeds, 1e-9);
    const colored = this.alone && fastest > 1e-3;
    const own = new THREE.Color(this.alone ? this.palette.rear : this.vehicle.color);
    const colors = speeds.flatMap((speed) => (colored ? shade(this.colors, speed / fastest) : own).toArray());
    const geometry = new THREE.LineGeometry();
    geometry.setPositions(places.flat());
    geometry.setColors(colors);
    this.trail = new THREE.Line2(geometry, new THREE.LineMaterial({ linewidth: 4.5, vertexColors: true, transparent: true }));
    this.trail.frustumCulled = false;
    this.trail.renderOrder = 4; // over the plan, which lies in the same place

    this.whole = new THREE.Line2(new THREE.LineGeometry().setPositions(plan.flat()), new THREE.LineMaterial({
      color: own, linewidth: 2.2, transparent: true, opacity: 0.75, depthWrite: false,
    }));
    this.whole.frustumCulled = false;
    this.whole.renderOrder = 3;
    // Where a building stands before the way, it shines through faintly.
    const through = new THREE.Line2(this.whole.geometry, new THREE.LineMaterial({
      color: own, linewidth: 2.2, transparent: true, opacity: 0.22, depthTest: false,
    }));
    through.frustumCulled = false;
    const track = new THREE.Line(
      new THREE.BufferGeometry().setFromPoints(places.map(([x, y]) => new THREE.Vector3(x, y, this.floor))),
      new THREE.LineBasicMaterial({ color: this.palette.muted, transparent: true, opacity: 0.5 }),
    );
    track.renderOrder = 2;
    this.drop = new THREE.Line(
      new THREE.BufferGeometry().setFromPoints([new THREE.Vector3(), new THREE.Vector3()]),
      new THREE.LineBasicMaterial({ color: this.palette.muted, transparent: true, opacity: 0.8 }),
    );
    this.drop.frustumCulled = false;
    return [this.whole, through, this.trail, track, this.drop];
  }

  goal() {
    const group = new THREE.Group();
    const size = 0.5 * Math.max(this.vehicle.span, 0.02 * Math.hypot(...this.vehicle.goal.map((g, i) => g - this.vehicle.places[0][i])));
    const ring = new THREE.Mesh(
      new THREE.TorusGeometry(size, 0.06 * size, 12, 64),
      new THREE.MeshBasicMaterial({ color: this.palette.goal }),
    );
    group.add(ring);
    group.position.set(...this.vehicle.goal);
    return group;
  }

  /** Frame before a time, and the share of the way to the next one. */
  frame(time) {
    const { times } = this.vehicle;
    if (time >= times.at(-1)) return [times.length - 2, 1];
    let low = 0, high = times.length - 1;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (times[middle] <= time) low = middle; else high = middle;
    }
    return [low, Math.max(0, (time - times[low]) / (times[low + 1] - times[low]))];
  }

  between(values, [i, share]) {
    return values[i].map((value, j) => value + share * (values[i + 1][j] - value));
  }

  /** Put the craft where it is at a time; `seconds` have passed on the screen. */
  moveTo(time, seconds) {
    const frame = this.frame(time), [i, share] = frame;
    this.place = new THREE.Vector3(...this.between(this.vehicle.places, frame));
    this.speed = this.vehicle.speeds[i] + share * (this.vehicle.speeds[i + 1] - this.vehicle.speeds[i]);
    this.velocity = new THREE.Vector3(...this.vehicle.places[i + 1]).sub(new THREE.Vector3(...this.vehicle.places[i]));
    this.body.position.copy(this.place);
    this.body.quaternion.copy(quaternion(this.vehicle.turns[i]).slerp(quaternion(this.vehicle.turns[i + 1]), share));
    this.trail.geometry.instanceCount = Math.min(i + (share > 0.5 ? 1 : 0), this.vehicle.places.length - 1);
    this.trail.visible = this.trail.geometry.instanceCount > 0;
    this.drop.geometry.setFromPoints([this.place, new THREE.Vector3(this.place.x, this.place.y, this.floor)]);
    const thrusts = this.vehicle.thrusts && this.between(this.vehicle.thrusts, frame);
    this.rotors.forEach((rotor, k) => this.turn(rotor, thrusts && thrusts[k], seconds));
  }

  turn(rotor, thrust, seconds) {
    const share = thrust === null ? 0.5 : Math.min(Math.max(thrust / this.vehicle.thrustMax, 0), 1);
    // Clockwise seen from above is positive about z down. Slower than life, to be seen.
    rotor.angle += rotor.spin * seconds * 14 * Math.sqrt(share);
    rotor.blades.rotation.z = rotor.angle;
    rotor.jet.scale.set(1, 1, Math.max(1e-3, 3.2 * share * this.vehicle.radius));
    rotor.jet.material.color.copy(shade(this.colors, share));
  }

  /** Draw the craft large enough to be seen; true to scale from near by. Returns the factor. */
  sizeFor(camera, least) {
    const away = camera.position.distanceTo(this.place);
    const factor = Math.max(1, (least * away) / this.vehicle.span);
    this.body.scale.setScalar(factor);
    return factor;
  }
}
