// The 3D viewer: one or two robots, a clock, and the controls.
import * as THREE from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { stateText } from "./caption.js";
import { developing, readPalette } from "./colours.js";
import { element, short } from "./elements.js";
import { Ground } from "./ground.js";
import { legend } from "./legend.js";
import { Life } from "./life.js";
import { described, pick } from "./picking.js";
import { bodyJson, fileName, linkTo, save } from "./share.js";
import { Stage } from "./stage.js";
import { cameraFor, pixelsOfMetre, place, views } from "./views.js";

const speeds = [0.1, 0.25, 0.5, 1, 2, 4];
/** Whether this browser can draw the viewer. */
export function hasGraphics() {
  const context = element("canvas").getContext("webgl2");
  context?.getExtension("WEBGL_lose_context")?.loseContext(); // a browser allows few contexts
  return context !== null;
}

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
    this.view = "perspective";
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
      ariaLabel: "The robot. Drag to turn it, pinch to come nearer; after a click, the wheel comes nearer, too.",
    });
    this.ruler = element("div", { className: "ruler" }, element("i"), element("span"));
    this.filmClock = element("div", { className: "film-clock" });
    this.captions = [0, 1].map(() => element("div", { className: "caption" }, element("strong"), element("span")));
    this.stage = element("div", { className: "stage" }, this.canvas, ...this.captions, this.ruler, this.filmClock);
    this.note = element("p", { className: "note" });
    this.picked = element("p", { className: "picked", hidden: true, ariaLive: "polite" });
    this.root = element(
      "section",
      { className: "viewer" },
      this.#pickers(),
      this.stage,
      this.#transport(),
      this.#lifeBar(),
      this.picked,
      this.#looks(),
      this.#leaving(),
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
    this.thickBox = element("input", { type: "checkbox", onchange: (e) => this.setThick(e.target.checked) });
    return element(
      "div",
      { className: "life" },
      element("label", {}, element("span", { textContent: "Life" }), this.cycle),
      this.cycleName,
      element("label", { className: "check" }, this.followBox, element("span", { textContent: "Follow" })),
      element("label", { className: "check" }, this.thickBox, element("span", { textContent: "Thick springs" })),
      this.#viewPicker(),
    );
  }

  #viewPicker() {
    const option = ([value, { label }]) => element("option", { value, textContent: label });
    this.viewSelect = element(
      "select",
      { onchange: (event) => this.setView(event.target.value) },
      ...Object.entries(views).map(option),
    );
    return element("label", {}, element("span", { textContent: "View" }), this.viewSelect);
  }

  /** Creates the buttons that take something out of the page, or fill the screen. */
  #leaving() {
    const button = (text, onclick) => element("button", { type: "button", textContent: text, onclick });
    this.linkButton = button("Copy link", () => this.#copyLink());
    return element(
      "div",
      { className: "leaving" },
      button("Full screen", () => this.#fillScreen()),
      button("Save picture", () => this.#savePicture()),
      button("Save body", () => this.#saveBodies()),
      this.linkButton,
    );
  }

  #fillScreen() {
    if (document.fullscreenElement) document.exitFullscreen();
    else this.root.requestFullscreen();
  }

  #savePicture() {
    this.draw();
    const name = `${this.#shownNames()}-${this.time.toFixed(2)}-s`;
    this.canvas.toBlob((picture) => save(fileName(name, "png"), picture));
  }

  #saveBodies() {
    this.stages
      .filter(({ life }) => life.shots.length > 0)
      .forEach(({ life }) => {
        const name = `individual-${life.robot.individual}-${this.time.toFixed(2)}-s`;
        save(fileName(name, "json"), bodyJson(life, this.time));
      });
  }

  async #copyLink() {
    history.replaceState(null, "", linkTo(this));
    let text = "Link copied";
    await navigator.clipboard?.writeText(location.href).catch(() => (text = "The link is in the address bar"));
    this.linkButton.textContent = text;
  }

  #shownNames() {
    return this.stages.map(({ life }) => `individual-${life.robot.individual}`).join("-");
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
    this.camera = new THREE.PerspectiveCamera(); // that the user turns; cameraFor() makes those that draw
    this.camera.up.set(0, 0, 1);
    this.orbit = new OrbitControls(this.camera, this.canvas);
    this.orbit.addEventListener("change", () => (this.dirty = true));
    // the wheel scrolls the page until the robot has been clicked
    this.orbit.enableZoom = false;
    this.canvas.addEventListener("pointerdown", () => (this.orbit.enableZoom = true), { capture: true });
    let pressed;
    this.canvas.addEventListener("pointerdown", ({ clientX, clientY }) => (pressed = [clientX, clientY]));
    this.canvas.addEventListener("pointerup", (event) => {
      if (pressed && Math.hypot(event.clientX - pressed[0], event.clientY - pressed[1]) < 4) this.#pickAt(event);
    });
    this.canvas.addEventListener("blur", () => (this.orbit.enableZoom = false));
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
      if (event.ctrlKey || event.metaKey || event.altKey) return;
      const action = this.#keys()[event.key];
      if (!action || belongsTo(event.target, event.key)) return;
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
      t: () => this.setThick(!this.thickBox.checked),
      r: () => this.setView(this.view),
      v: () => this.#fillScreen(),
    };
  }

  /** Describes the mass or the spring at the place of an event, if there is one. */
  #pickAt({ offsetX, offsetY }) {
    const { height } = this;
    this.pick = undefined;
    this.stages.forEach((stage, k) => {
      const [x, y, across, up] = this.#viewport(k);
      const place = [offsetX - x, offsetY - (height - y - up)];
      if (place[0] < 0 || place[1] < 0 || place[0] > across || place[1] > up) return;
      const found = pick(stage, this.#cameraOf(stage, across / up), place, [across, up]);
      if (found) this.pick = { stage, ...found };
    });
    this.#describePick();
  }

  #describePick() {
    const isShown = this.pick !== undefined && this.stages.includes(this.pick.stage);
    this.picked.hidden = !isShown;
    if (isShown) this.picked.replaceChildren(...described(this.pick.stage, this.pick, this.time));
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
    this.setThick(this.thickBox.checked);
    this.setView(this.view);
    this.#explain();
    this.seek(this.begin);
    this.onshow(indices);
  }

  /** Shows what a link says, as linked() returns it. */
  async restore({ robot, beside, time, colour, view, camera }) {
    await this.show(robot, beside);
    if (this.works && ["material", "stress", "cycle"].includes(colour)) this.setMode(colour);
    if (Object.hasOwn(views, view)) this.setView(view);
    if (camera) {
      this.camera.position.fromArray(camera);
      this.orbit.target.fromArray(camera, 3);
      this.orbit.update();
    }
    if (Number.isFinite(time)) this.seek(time);
  }

  /** Shows a robot, and scrolls to the viewer. */
  async open(index) {
    this.root.scrollIntoView({ behavior: "smooth" });
    await this.show(index);
  }

  async #life(index) {
    if (!this.lives.has(index)) this.lives.set(index, Life.of(this.robots[index].robot, this.robots[index].run.direction));
    return this.lives.get(index);
  }

  /** Returns the life with the most shots, whose cycles the slider shows. */
  #leading() {
    return this.stages.map((stage) => stage.life).reduce((a, b) => (b.shots.length > a.shots.length ? b : a));
  }

  #shotIndex() {
    return Math.max(0, this.#leading().shotAt(this.time));
  }

  /** Looks at the robots from a direction of `views`; all but "perspective" are orthographic. */
  setView(view) {
    this.view = this.viewSelect.value = view;
    const size = Math.max(...this.stages.map((stage) => stage.size));
    this.orbit.target.set(0, 0, 0);
    place(this.camera, view, size);
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
    this.#describePick();
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

  /** Draws springs so thick that a network looks like a body. */
  setThick(thick) {
    this.thickBox.checked = thick;
    this.stages.forEach((stage) => stage.setThick(thick));
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
    this.legend.replaceChildren(...(shown.length > 0 ? legend(this.mode, shown, this.scale) : []));
    this.note.textContent = shown.length > 0 ? this.#exactness(shown.map((stage) => stage.life.robot.film.error)) : "";
  }

  /** Returns a text on how far the films shown may deviate from the simulation. The text states the larger one of the
  *  films' deviations. */
  #exactness(errors) {
    const worst = (kind) => Math.max(...errors.map((error) => error[kind]));
    const within = `Positions are shown to within ${short(1000 * worst("most"))} mm 99 times in 100, and to within ${short(1000 * worst("largest"))} mm always`;
    return this.works ? `${within}; stress to within ${short(worst("stress"))} N.` : `${within}.`;
  }

  #writeCaptions() {
    const shown = this.chosen.filter((i) => i !== undefined).map((i) => this.robots[i]);
    this.captions.forEach((caption, k) => {
      const texts = k < this.stages.length ? [shown[k].label, stateText(this.stages[k].life, this.time)] : ["", ""];
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
    this.stage.classList.toggle("stacked", this.#isStacked());
    this.stages.forEach((stage, k) => this.#drawStage(stage, this.#viewport(k), ratio));
    this.#writeCaptions();
    this.#drawRuler(this.#viewport(0));
    this.filmClock.textContent = `${this.time.toFixed(1)} s`;
  }

  /** Draws a bar that has a round length at the distance of the robot. */
  #drawRuler([, , width, height]) {
    const pixels = pixelsOfMetre(width, height, this.camera, this.orbit.target);
    const most = 150 / pixels;
    const power = 10 ** Math.floor(Math.log10(most));
    const length = power * [5, 2, 1].find((digit) => digit * power <= most);
    this.ruler.firstChild.style.width = `${length * pixels}px`;
    this.ruler.lastChild.textContent = `${short(length)} m`;
  }

  /** Whether two robots are one above the other, as on a phone. */
  #isStacked() {
    return this.stages.length > 1 && this.height > 1.1 * this.width;
  }

  /** Returns the part of the picture in which the k-th robot is: x and y of its lower left corner, width and height. */
  #viewport(k) {
    const { width, height } = this;
    const n = this.stages.length;
    return this.#isStacked() ? [0, ((n - 1 - k) * height) / n, width, height / n] : [(k * width) / n, 0, width / n, height];
  }

  #drawStage(stage, [x, y, width, height], ratio) {
    stage.seek(this.time, this.follow);
    this.renderer.setViewport(x, y, width, height);
    this.renderer.setScissor(x, y, width, height);
    this.renderer.clear();
    stage.draw(this.renderer, this.#cameraOf(stage, width / height), height * ratio);
  }

  /** Returns the camera of a stage in a picture with an aspect ratio. */
  #cameraOf(stage, aspect) {
    return cameraFor(stage, aspect, this.view, this.camera, this.orbit.target);
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

/** Whether a key belongs to the control that has the focus, and not to the viewer. */
function belongsTo(target, key) {
  const control = target.closest?.("input,select,textarea,button,summary,a");
  if (!control) return false;
  if (control.matches("select,textarea,input:not([type=range],[type=radio],[type=checkbox])")) return true;
  return key === " " || (key.startsWith("Arrow") && control.matches("[type=range],[type=radio]"));
}

const keys = () =>
  element(
    "details",
    { className: "keys" },
    element("summary", { textContent: "Keys" }),
    element("p", {
      textContent:
        "Space plays and pauses. ← and → step by a frame, with Shift by a second. [ and ] go from cycle to cycle. + and − change the speed. C changes the colour, F follows, T makes springs thick, R turns the camera back, V fills the screen. A click on a mass or a spring says what it is. Drag turns, the wheel (after a click) or two fingers zoom, right drag or two fingers move.",
    }),
  );
