// The 3D viewer: one or two robots, a clock, and the controls.
import * as THREE from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { colourBar, css, cycleColour, developing, materialColour, readPalette, stressColour } from "./colours.js";
import { element, short } from "./elements.js";
import { Ground } from "./ground.js";
import { Life } from "./life.js";
import { Stage } from "./stage.js";

const speeds = [0.1, 0.25, 0.5, 1, 2, 4];
const framing = 2.9; // distance of the camera, in multiples of the body's size

export class Viewer {
  /** Creates a viewer of robots, each given as {label, robot, run}. */
  constructor(robots) {
    this.robots = robots;
    this.lives = new Map();
    this.stages = [];
    this.chosen = [];
    this.time = 0;
    this.playing = false;
    this.speed = 1;
    this.follow = true;
    this.mode = "material";
    this.onshow = () => {}; // called with the indices of the robots shown
    this.works = robots.some(({ robot }) => robot.film.most_stress > 0); // false if no robot was simulated
    this.#build();
    this.#makeRenderer();
    this.#listen();
    requestAnimationFrame((now) => this.#tick(now));
  }

  #build() {
    this.canvas = element("canvas", {
      tabIndex: 0,
      ariaLabel: "The robot. Drag to turn, pinch or wheel to come nearer.",
    });
    this.captions = [0, 1].map(() => element("div", { className: "caption" }, element("strong"), element("span")));
    this.stage = element("div", { className: "stage" }, this.canvas, ...this.captions);
    this.note = element("p", { className: "note" });
    this.root = element(
      "section",
      { className: "viewer" },
      this.#pickers(),
      this.stage,
      this.#transport(),
      this.#lifeBar(),
      this.#looks(),
      this.note,
      keys(),
    );
    this.#showPlaying();
  }

  /** Creates the controls that choose the robots shown. */
  #pickers() {
    const choose = (label, which, options) =>
      element(
        "label",
        { className: "choice" },
        element("span", { textContent: label }),
        element("select", { onchange: (e) => this.#pick(which, e.target.value) }, ...options),
      );
    const options = () =>
      this.robots.map(({ label }, i) => element("option", { value: String(i), textContent: label }));
    this.first = choose("Robot", 0, options());
    this.second = choose("beside", 1, [element("option", { value: "", textContent: "none" }), ...options()]);
    return element("div", { className: "pickers" }, this.first, this.robots.length > 1 ? this.second : null);
  }

  /** Creates the controls of the clock. */
  #transport() {
    this.play = element("button", { className: "play", type: "button", onclick: () => this.toggle() });
    this.scrub = element("input", {
      type: "range",
      min: "0",
      max: "1",
      step: "any",
      value: "0",
      ariaLabel: "Time",
      oninput: (e) => this.#scrubbed(Number(e.target.value)),
    });
    this.clock = element("output", { className: "clock" });
    this.speedSelect = element(
      "select",
      { ariaLabel: "Speed", onchange: (e) => (this.speed = Number(e.target.value)) },
      ...speeds.map((s) => element("option", { value: String(s), textContent: `${s}×`, selected: s === 1 })),
    );
    return element("div", { className: "transport" }, this.play, this.scrub, this.clock, this.speedSelect);
  }

  /** Creates the controls that go from cycle to cycle. */
  #lifeBar() {
    this.cycle = element("input", {
      type: "range",
      min: "0",
      max: "0",
      step: "1",
      value: "0",
      ariaLabel: "Cycle of life",
      oninput: (e) => this.#jumped(Number(e.target.value)),
    });
    this.cycleName = element("output", { className: "cycle-name" });
    this.followBox = element("input", {
      type: "checkbox",
      checked: true,
      onchange: (e) => this.setFollow(e.target.checked),
    });
    return element(
      "div",
      { className: "life" },
      element("label", {}, element("span", { textContent: "Life" }), this.cycle),
      this.cycleName,
      element("label", { className: "check" }, this.followBox, element("span", { textContent: "Follow" })),
    );
  }

  /** Creates the choice of colours and their legend. */
  #looks() {
    const choice = ([mode, label]) =>
      element(
        "label",
        {},
        element("input", {
          type: "radio",
          name: "colour",
          value: mode,
          checked: mode === this.mode,
          onchange: () => this.setMode(mode),
        }),
        element("span", { textContent: label }),
      );
    this.modes = element(
      "fieldset",
      { className: "modes" },
      element("legend", { textContent: "Colour" }),
      ...Object.entries({ material: "Material", stress: "Stress", cycle: "Came in" }).map(choice),
    );
    this.legend = element("div", { className: "legend" });
    return element("div", { className: "looks" }, this.works ? this.modes : null, this.legend);
  }

  #makeRenderer() {
    this.renderer = new THREE.WebGLRenderer({ canvas: this.canvas, antialias: true, stencil: true });
    this.renderer.outputColorSpace = THREE.LinearSRGBColorSpace; // no conversion: colours as in the style sheet
    this.renderer.autoClear = false;
    this.camera = new THREE.PerspectiveCamera(32, 1, 0.01, 1000);
    this.camera.up.set(0, 0, 1);
    this.orbit = new OrbitControls(this.camera, this.canvas);
    this.orbit.addEventListener("change", () => (this.dirty = true));
    new ResizeObserver(() => this.#measure()).observe(this.stage);
  }

  /** Stores the size of the stage. Reading it in every frame would cause a layout of the page each time. */
  #measure() {
    this.width = this.stage.clientWidth;
    this.height = this.stage.clientHeight;
    this.dirty = true;
  }

  #listen() {
    document.addEventListener("keydown", (event) => {
      if (
        event.target.closest?.("input:not([type=range]),select,textarea") ||
        event.ctrlKey ||
        event.metaKey ||
        event.altKey
      )
        return;
      const action = this.#keys()[event.key];
      if (!action || (event.target.closest?.("button,summary") && event.key === " ")) return;
      event.preventDefault();
      action(event);
    });
  }

  #keys() {
    const step = (sign) => (event) => (this.pause(), this.seek(this.time + sign * (event.shiftKey ? 1 : 1 / 30)));
    const speed = (by) => () =>
      this.setSpeed(speeds[Math.min(speeds.length - 1, Math.max(0, speeds.indexOf(this.speed) + by))]);
    return {
      " ": () => this.toggle(),
      ArrowLeft: step(-1),
      ArrowRight: step(1),
      "[": () => this.#jumped(this.#shotIndex() - 1),
      "]": () => this.#jumped(this.#shotIndex() + 1),
      "+": speed(1),
      "-": speed(-1),
      c: () => this.works && this.setMode({ material: "stress", stress: "cycle", cycle: "material" }[this.mode]),
      f: () => this.setFollow(!this.follow),
      r: () => this.#frameBody(),
    };
  }

  async #pick(which, value) {
    const chosen = [...this.chosen];
    chosen[which] = value === "" ? undefined : Number(value);
    await this.show(chosen[0], chosen[1]);
  }

  /** Shows a robot and, optionally, a second one beside it. */
  async show(first, second) {
    this.chosen = [first, second];
    const indices = this.chosen.filter((i) => i !== undefined);
    const lives = await Promise.all(indices.map((i) => this.#life(i)));
    const grounds = await Promise.all(indices.map((i) => Ground.of(this.robots[i].run.scene)));
    if (this.chosen[0] !== first || this.chosen[1] !== second) return; // the user has chosen other robots meanwhile
    this.stages.forEach((stage) => stage.dispose());
    this.stages = lives.map((life, k) => new Stage(life, this.robots[indices[k]].run, grounds[k]));
    // both robots have the same scale, so that they can be compared
    this.scale = {
      stress: Math.max(...lives.map((life) => life.robot.film.most_stress ?? 0)),
      cycles: Math.max(...lives.map(developing)),
    };
    this.stages.forEach((stage) => (stage.scale = this.scale));
    this.first.querySelector("select").value = String(first);
    this.second.querySelector("select").value = second === undefined ? "" : String(second);
    this.stage.classList.toggle("two", indices.length > 1);
    this.end = Math.max(...lives.map((life) => life.end));
    this.begin = Math.min(...lives.map((life) => life.begin));
    this.scrub.min = String(this.begin);
    this.scrub.max = String(this.end);
    this.cycle.max = String(Math.max(0, this.#leading().shots.length - 1));
    this.stages.forEach((stage) => stage.setMode(this.mode));
    this.#frameBody();
    this.#explain();
    this.seek(this.begin);
    this.onshow(indices);
  }

  /** Shows a robot, and scrolls to the viewer. */
  async open(index) {
    this.root.scrollIntoView({ behavior: "smooth" });
    await this.show(index);
  }

  async #life(index) {
    if (!this.lives.has(index)) this.lives.set(index, Life.of(this.robots[index].robot));
    return this.lives.get(index);
  }

  /** Returns the life with the most shots, whose cycles the slider shows. */
  #leading() {
    return this.stages.map((stage) => stage.life).reduce((a, b) => (b.shots.length > a.shots.length ? b : a));
  }

  #shotIndex() {
    return Math.max(0, this.#leading().shotAt(this.time));
  }

  #frameBody() {
    const size = Math.max(...this.stages.map((stage) => stage.size));
    this.orbit.target.set(0, 0, 0);
    this.camera.position
      .set(0.55, -1, 0.42)
      .normalize()
      .multiplyScalar(framing * size);
    this.camera.near = 0.01 * size;
    this.camera.far = 60 * size;
    this.orbit.minDistance = 0.3 * size;
    this.orbit.maxDistance = 25 * size;
    this.orbit.update();
    this.dirty = true;
  }

  seek(time) {
    this.time = Math.min(this.end, Math.max(this.begin, time));
    this.scrub.value = String(this.time);
    this.dirty = true;
    this.clock.value = `${this.time.toFixed(2)} s of ${this.end.toFixed(1)}`;
    const shots = this.#leading().shots;
    if (shots.length === 0) return;
    const index = this.#shotIndex();
    this.cycle.value = String(index);
    this.cycleName.value = shots[index].name;
  }

  #scrubbed(time) {
    this.pause();
    this.seek(time);
  }

  #jumped(index) {
    const shots = this.#leading().shots;
    if (shots.length === 0) return;
    this.pause();
    this.seek(shots[Math.min(shots.length - 1, Math.max(0, index))].begin);
  }

  toggle() {
    if (!this.playing && this.time >= this.end) this.seek(this.begin);
    this.playing = !this.playing;
    this.#showPlaying();
  }

  pause() {
    this.playing = false;
    this.#showPlaying();
  }

  #showPlaying() {
    this.play.textContent = this.playing ? "❚❚" : "▶";
    this.play.ariaLabel = this.playing ? "Pause" : "Play";
  }

  setSpeed(speed) {
    this.speed = speed;
    this.speedSelect.value = String(speed);
  }

  setMode(mode) {
    this.mode = mode;
    this.modes.querySelector(`[value=${mode}]`).checked = true;
    this.stages.forEach((stage) => stage.setMode(mode));
    this.#explain();
    this.dirty = true;
  }

  setFollow(follow) {
    this.follow = this.followBox.checked = follow;
    this.dirty = true;
  }

  readTheme() {
    readPalette();
    this.stages.forEach((stage) => stage.readTheme());
    if (this.stages.length > 0) this.#explain();
    this.dirty = true;
  }

  /** Updates the legend of the colours and the note on the accuracy of the picture. */
  #explain() {
    const shown = this.stages.filter((stage) => stage.life.shots.length > 0);
    this.legend.replaceChildren(...(shown.length > 0 ? this.#legend() : []));
    this.note.textContent = shown.length > 0 ? this.#exactness(shown.map((stage) => stage.life.robot.film.error)) : "";
  }

  /** Returns a text on how far the films shown may deviate from the simulation. The text states the larger one of the
  *  films' deviations. */
  #exactness(errors) {
    const worst = (kind) => Math.max(...errors.map((error) => error[kind]));
    const within = `Positions are shown to within ${short(1000 * worst("most"))} mm 99 times in 100, and to within ${short(1000 * worst("largest"))} mm always`;
    return this.works ? `${within}; stress to within ${short(worst("stress"))} N.` : `${within}.`;
  }

  #legend() {
    const swatch = (colour, text) =>
      element(
        "span",
        { className: "swatch" },
        element("i", { style: `background:${css(colour)}` }),
        element("span", { textContent: text }),
      );
    if (this.mode === "stress")
      return colourBar(stressColour, "0 N", `${short(this.scale.stress)} N (root scale)`);
    if (this.mode === "cycle") {
      const { cycles } = this.scale;
      const born = swatch(cycleColour(0, cycles), "there from birth");
      return cycles > 1
        ? [
            born,
            ...colourBar((t) => cycleColour(1 + t * (cycles - 2), cycles), "after cycle 1", `after cycle ${cycles - 1}`),
          ]
        : [born];
    }
    const materials = new Map();
    for (const { life, materialNames } of this.stages)
      materialNames.forEach((name, i) => {
        const all = life.robot.film.materials ?? [];
        if (all[i]?.stiffness > 0 && !materials.has(name)) materials.set(name, materialColour(all[i], all));
      });
    return [...materials].map(([name, colour]) => swatch(colour, name));
  }

  /** Returns the name of a robot, and a line on its current state. */
  #caption(k) {
    const { life } = this.stages[k];
    const name = this.robots[this.chosen.filter((i) => i !== undefined)[k]].label;
    if (life.shots.length === 0) return [name, `${life.robot.status}: ${life.robot.reason}`];
    const shot = life.shots[life.shotAt(this.time)];
    const measured = life.shots.find(({ name: n }) => n.startsWith("measured")); // and where, if there are scenarios
    const gone = shot.gone.length;
    const { springs, masses } = shot;
    const text = [shot.name, springs.length > 0 ? `${springs.length} springs` : `${masses.length} points`];
    if (gone + shot.came > 0) text.push(`−${gone} +${shot.came}`);
    if (measured && this.time > measured.begin)
      text.push(`moved ${distance(life.middleAt(this.time), life.middleAt(measured.begin)).toFixed(2)} m`);
    return [name, text.join(" · ")];
  }

  #writeCaptions() {
    this.captions.forEach((caption, k) => {
      const texts = k < this.stages.length ? this.#caption(k) : ["", ""];
      texts.forEach((text, line) => {
        if (caption.children[line].textContent !== text) caption.children[line].textContent = text;
      });
    });
  }

  /** Draws the robots at the current time. */
  draw() {
    this.dirty = false;
    if (!this.width) this.#measure();
    const { width, height } = this;
    if (width === 0 || this.stages.length === 0) return;
    const ratio = Math.min(devicePixelRatio, 2);
    const size = this.renderer.getSize(new THREE.Vector2());
    if (size.x !== width || size.y !== height || this.renderer.getPixelRatio() !== ratio) {
      this.renderer.setPixelRatio(ratio);
      this.renderer.setSize(width, height, false);
    }
    this.renderer.setScissorTest(true);
    const stacked = this.stages.length > 1 && height > 1.1 * width;
    this.stage.classList.toggle("stacked", stacked);
    this.stages.forEach((stage, k) => this.#drawStage(stage, this.#viewport(k, width, height, stacked), ratio));
    this.#writeCaptions();
  }

  #viewport(k, width, height, stacked) {
    const n = this.stages.length;
    return stacked ? [0, ((n - 1 - k) * height) / n, width, height / n] : [(k * width) / n, 0, width / n, height];
  }

  #drawStage(stage, [x, y, width, height], ratio) {
    stage.seek(this.time, this.follow);
    this.renderer.setViewport(x, y, width, height);
    this.renderer.setScissor(x, y, width, height);
    this.renderer.clear();
    const camera = this.camera.clone();
    camera.aspect = width / height;
    // widens the view of a narrow picture, so that it shows as much of the body as a wide one
    camera.fov =
      camera.aspect < 1
        ? 2 * Math.atan(Math.tan((camera.fov * Math.PI) / 360) / camera.aspect) * (180 / Math.PI)
        : camera.fov;
    camera.position.add(stage.target);
    camera.position.z += 0.05 * stage.size; // makes room for the caption above the body
    camera.updateProjectionMatrix();
    camera.updateMatrixWorld();
    stage.draw(this.renderer, camera, height * ratio);
  }

  #tick(now) {
    const passed = Math.min(0.1, (now - (this.last ?? now)) / 1000);
    this.last = now;
    if (this.playing) {
      this.seek(this.time + passed * this.speed);
      if (this.time >= this.end) this.pause();
    }
    if (this.dirty) this.draw();
    requestAnimationFrame((next) => this.#tick(next));
  }
}

const distance = (a, b) => Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);

const keys = () =>
  element(
    "details",
    { className: "keys" },
    element("summary", { textContent: "Keys" }),
    element("p", {
      textContent:
        "Space plays and pauses. ← and → step by a frame, with Shift by a second. [ and ] go from cycle to cycle. + and − change the speed. C changes the colour, F follows, R turns the camera back. Drag turns, the wheel or two fingers zoom, right drag or two fingers move.",
    }),
  );
