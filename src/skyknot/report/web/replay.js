// The replay: clock, controls, readout. One for every element of class "replay" on the page.

const RATES = [0.05, 0.1, 0.25, 0.5, 1, 2, 4, 8, 16, 32];
const PLEASANT = 20; // seconds that a whole flight should take on the screen, at most
const SLOW = 0.08; // seconds a picture may take before the replay draws coarser while it plays
const COARSE = 0.5; // share of the resolution then
const SMALLEST = 0.065; // span of the drawn craft over its distance from the viewer, at least

class Replay {
  constructor(root, data) {
    this.root = root;
    this.data = data;
    this.part = (name) => root.querySelector(`[data-part="${name}"]`);
    this.canvas = this.part("canvas");
    this.duration = Math.max(...data.vehicles.map((vehicle) => vehicle.times.at(-1)));
    this.time = 0;
    this.playing = false;
    this.rate = [...RATES].reverse().find((rate) => rate <= Math.max(1, this.duration / PLEASANT) && this.duration / rate >= 6) ?? RATES[0];
    this.renderer = new THREE.WebGLRenderer({ canvas: this.canvas, antialias: true });
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.type = THREE.PCFShadowMap;
    this.viewpoint = new Viewpoint(this.canvas, data);
    this.theme = window.matchMedia("(prefers-color-scheme: dark)");
    this.theme.addEventListener("change", () => { this.build(); this.draw(); });
    this.named = root.clientWidth > 640;
    this.build();
    this.connect();
    new ResizeObserver(() => this.resize()).observe(this.canvas.parentElement); // the first draw too
  }

  build() {
    const { data } = this;
    const palette = PALETTES[this.theme.matches ? "dark" : "light"];
    this.scene = new THREE.Scene();
    const size = this.viewpoint.size;
    this.scene.fog = new THREE.Fog(palette.horizon, 1.6 * size, 7 * size);
    this.scene.add(surroundings(data, palette));
    this.crafts = data.vehicles.map((vehicle) => new Craft(vehicle, data, palette, data.vehicles.length === 1));
    this.scene.add(...this.crafts.map((craft) => craft.group));
    this.names = this.nameThings(palette);
    this.scene.add(this.names);
    this.move(0);
  }

  nameThings(palette) {
    const group = new THREE.Group();
    const heights = { box: (body) => body.size[2] / 2, cylinder: (body) => body.height / 2, ellipsoid: (body) => body.axes[2] };
    for (const body of this.data.bodies) {
      if (body.kind === "tube") continue;
      const name = label(body.name, palette.ink, palette.roof, 12);
      name.position.set(body.center[0], body.center[1], body.center[2] + heights[body.kind](body));
      group.add(name);
    }
    if (this.data.vehicles.length > 1) {
      for (const craft of this.crafts) {
        craft.name = label(craft.vehicle.name, craft.vehicle.color, palette.ground, 13);
        this.scene.add(craft.name);
      }
    }
    return group;
  }

  connect() {
    const rates = this.part("rate"), views = this.part("view");
    rates.append(...RATES.map((rate) => new Option(`${rate} ×`, rate, rate === this.rate, rate === this.rate)));
    views.append(...Object.entries(VIEWS).map(([name, words]) => new Option(words, name)));
    this.part("play").addEventListener("click", () => this.toggle());
    this.part("scrub").addEventListener("input", (event) => this.seek((this.duration * event.target.value) / event.target.max));
    rates.addEventListener("change", () => { this.rate = Number(rates.value); });
    views.addEventListener("change", () => this.look(views.value));
    this.part("names").setAttribute("aria-pressed", String(this.named));
    this.part("names").addEventListener("click", () => this.toggleNames());
    this.viewpoint.controls.addEventListener("change", () => this.draw());
    this.canvas.addEventListener("keydown", (event) => this.key(event));
  }

  key(event) {
    const step = this.duration / 100;
    const actions = {
      " ": () => this.toggle(), k: () => this.toggle(), ArrowLeft: () => this.seek(this.time - step),
      ArrowRight: () => this.seek(this.time + step), Home: () => this.seek(0), End: () => this.seek(this.duration),
      c: () => this.nextView(),
    };
    if (event.ctrlKey || event.metaKey || event.altKey || !actions[event.key]) return;
    event.preventDefault();
    actions[event.key]();
  }

  toggle() {
    this.playing = !this.playing;
    if (this.playing && this.time >= this.duration) this.time = 0;
    const play = this.part("play");
    play.dataset.state = this.playing ? "playing" : "paused";
    play.setAttribute("aria-label", this.playing ? "Pause" : "Play");
    this.before = performance.now();
    this.slow = 0;
    if (!this.playing) this.sharpen(1);
    if (this.playing) requestAnimationFrame((now) => this.tick(now));
  }

  /** Set the resolution, as a share of the screen's own. */
  sharpen(share) {
    const ratio = share * Math.min(window.devicePixelRatio, 2);
    if (this.renderer.getPixelRatio() === ratio) return;
    this.renderer.setPixelRatio(ratio);
    this.draw();
  }

  toggleNames() {
    this.named = !this.named;
    this.part("names").setAttribute("aria-pressed", String(this.named));
    this.draw();
  }

  nextView() {
    const views = this.part("view");
    views.selectedIndex = (views.selectedIndex + 1) % views.options.length;
    this.look(views.value);
  }

  look(view) {
    this.viewpoint.choose(view, this.crafts[0]);
    this.draw();
  }

  seek(time) {
    this.time = Math.min(Math.max(time, 0), this.duration);
    this.move(0);
    this.draw();
  }

  tick(now) {
    if (!this.playing) return;
    const seconds = Math.min(Math.max((now - this.before) / 1000, 0), 0.25);
    this.slow = seconds > SLOW ? this.slow + 1 : 0;
    if (this.slow > 2) this.sharpen(COARSE);
    this.before = now;
    this.time = Math.min(this.time + seconds * this.rate, this.duration);
    this.move(seconds);
    this.draw();
    if (this.time >= this.duration) this.toggle();
    else requestAnimationFrame((later) => this.tick(later));
  }

  move(seconds) {
    for (const craft of this.crafts) craft.moveTo(this.time, seconds);
    this.moving = true;
    this.viewpoint.follow(this.crafts[0], seconds);
    this.moving = false;
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.canvas.parentElement;
    if (!width || !height) return;
    this.renderer.setSize(width, height, false);
    this.viewpoint.resize(width, height, this.crafts[0]);
    this.draw();
  }

  draw() {
    if (this.moving) return;
    const { camera } = this.viewpoint;
    const factors = this.crafts.map((craft) => craft.sizeFor(camera, SMALLEST));
    this.names.visible = this.named;
    this.crafts.forEach((craft, i) => {
      if (craft.name) craft.name.position.copy(craft.place).z += 0.7 * factors[i] * craft.vehicle.span;
    });
    this.scene.traverse((thing) => this.keepReadable(thing, camera));
    this.renderer.render(this.scene, camera);
    this.tell(factors[0]);
  }

  /** Give words the same number of pixels wherever they stand. */
  keepReadable(thing, camera) {
    if (!thing.isSprite) return;
    const unit = (2 * Math.tan(THREE.MathUtils.degToRad(camera.fov / 2))) / this.canvas.clientHeight;
    const [width, height] = thing.userData.pixels;
    thing.scale.set(width * unit, height * unit, 1);
  }

  tell(factor) {
    const [craft] = this.crafts;
    const height = craft.place.z;
    this.part("time").textContent = `${this.time.toFixed(this.duration < 10 ? 2 : 1)} s`;
    this.part("speed").textContent = `${craft.speed.toFixed(1)} m/s`;
    this.part("height").textContent = `${height.toFixed(1).replace("-", "−")} m`;
    this.part("grid").textContent = `${gridSpacing(this.viewpoint.low, this.viewpoint.high)} m`;
    this.part("factor").textContent = factor > 1.05 ? `× ${factor.toPrecision(2)}` : "to scale";
    const scrub = this.part("scrub");
    scrub.value = String((scrub.max * this.time) / this.duration);
    scrub.setAttribute("aria-valuetext", `${this.time.toFixed(1)} of ${this.duration.toFixed(1)} seconds`);
    this.root.dataset.time = String(this.time);
    this.root.dataset.place = craft.place.toArray().map((value) => value.toFixed(3)).join(" ");
  }
}

function startReplays() {
  for (const root of document.querySelectorAll(".replay")) {
    const probe = document.createElement("canvas").getContext("webgl2");
    if (!probe) continue; // a sentence stands in its place
    probe.getExtension("WEBGL_lose_context")?.loseContext();
    const data = JSON.parse(root.querySelector("script[type='application/json']").textContent);
    root.dataset.state = "ready";
    root.replay = new Replay(root, data);
  }
}

startReplays();
