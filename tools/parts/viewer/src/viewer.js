// The 3D viewer: one or two robots, a clock, and the controls.
import * as THREE from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { stateText } from "./caption.js";
import { developing, readPalette } from "./colours.js";
import { Controls, keys, linkLabel, speeds } from "./controls.js";
import { element, prefersStill, short } from "./elements.js";
import { Ground } from "./ground.js";
import { legend } from "./legend.js";
import { Life } from "./life.js";
import { described, pick } from "./picking.js";
import { bodyJson, fileName, linkTo, robotName, save } from "./share.js";
import { Stage } from "./stage.js";
import { Traces } from "./traces.js";
import { cameraFor, pixelsOfMetre, place, views } from "./views.js";

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
    this.controls = new Controls(this);
    this.traces = new Traces();
    this.canvas = element("canvas", {
      tabIndex: 0,
      "aria-label": "The robot. Drag to turn it, pinch to come nearer; after a click, the wheel comes nearer, too.",
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
      ...this.controls.above,
      element("div", { className: "scene" }, this.stage, this.traces.root),
      ...this.controls.below,
      this.picked,
      ...this.controls.last,
      this.note,
      keys(),
    );
  }

  fillScreen() {
    if (document.fullscreenElement) document.exitFullscreen();
    else this.root.requestFullscreen();
  }

  savePicture() {
    this.draw();
    const name = `${this.#shownNames()}-${this.time.toFixed(2)}-s`;
    this.canvas.toBlob((picture) => save(fileName(name, "png"), picture));
  }

  saveBodies() {
    this.stages
      .filter(({ life }) => life.shots.length > 0)
      .forEach(({ life }) => {
        const name = `${robotName(life.robot)}-${this.time.toFixed(2)}-s`;
        save(fileName(name, "json"), bodyJson(life, this.time));
      });
  }

  async copyLink() {
    history.replaceState(null, "", linkTo(this));
    const isCopied = await navigator.clipboard?.writeText(location.href).then(
      () => true,
      () => false,
    );
    this.controls.linkButton.textContent = isCopied ? "Link copied" : "The link is in the address bar";
    setTimeout(() => (this.controls.linkButton.textContent = linkLabel), 3000);
  }

  #shownNames() {
    return this.stages.map(({ life }) => robotName(life.robot)).join("-");
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
      if (event.ctrlKey || event.metaKey || event.altKey || !this.isReady) return;
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
      "[": () => this.jump(this.#shotIndex() - 1),
      "]": () => this.jump(this.#shotIndex() + 1),
      "+": speed(1),
      "-": speed(-1),
      c: () => this.works && this.setMode({ material: "stress", stress: "cycle", cycle: "material" }[this.mode]),
      f: () => this.setFollow(!this.follow),
      t: () => this.setThick(!this.controls.thickBox.checked),
      s: () => this.hasVoxels && this.setSkin(!this.controls.skinBox.checked),
      r: () => this.setView(this.view),
      v: () => this.fillScreen(),
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
    this.traces.show(isShown && this.works ? this.pick : undefined);
    this.traces.seek(this.time);
    if (isShown) this.picked.replaceChildren(...described(this.pick.stage, this.pick, this.time));
  }

  async choose(which, value) {
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
    this.controls.first.querySelector("select").value = String(first);
    this.controls.second.querySelector("select").value = second === undefined ? "" : String(second);
    this.stage.classList.toggle("two", indices.length > 1);
    this.end = Math.max(...lives.map((life) => life.end));
    this.begin = Math.min(...lives.map((life) => life.begin));
    this.controls.scrub.min = String(this.begin);
    this.controls.scrub.max = String(this.end);
    this.controls.cycle.max = String(Math.max(0, this.#leading().shots.length - 1));
    this.stages.forEach((stage) => stage.setMode(this.mode));
    this.setThick(this.controls.thickBox.checked);
    this.hasVoxels = lives.some(({ voxels }) => voxels.length > 0);
    this.controls.skin.hidden = !this.hasVoxels;
    this.setSkin(this.controls.skinBox.checked);
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

  /** Shows a robot, then scrolls to the viewer, whose place on the page depends on what it shows. */
  async open(index) {
    await this.show(index);
    this.root.scrollIntoView({ behavior: prefersStill() ? "instant" : "smooth" });
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
    this.view = this.controls.viewSelect.value = view;
    const size = Math.max(...this.stages.map((stage) => stage.size));
    this.orbit.target.set(0, 0, 0);
    place(this.camera, view, size);
    this.orbit.minDistance = 0.3 * size;
    this.orbit.maxDistance = 25 * size;
    this.orbit.update();
    this.dirty = true;
  }

  /** Whether there is a robot to show; the first one takes a moment to unpack. */
  get isReady() {
    return this.stages.length > 0;
  }

  seek(time) {
    if (!this.isReady) return;
    this.time = Math.min(this.end, Math.max(this.begin, time));
    this.controls.scrub.value = String(this.time);
    this.dirty = true;
    this.controls.clock.value = `${this.time.toFixed(2)} s of ${this.end.toFixed(1)}`;
    this.#describePick();
    const shots = this.#leading().shots;
    if (shots.length === 0) return;
    const index = this.#shotIndex();
    this.controls.cycle.value = String(index);
    this.controls.cycleName.value = shots[index].name;
  }

  scrub(time) {
    this.pause();
    this.seek(time);
  }

  jump(index) {
    if (!this.isReady) return;
    const shots = this.#leading().shots;
    if (shots.length === 0) return;
    this.pause();
    this.seek(shots[Math.min(shots.length - 1, Math.max(0, index))].begin);
  }

  toggle() {
    if (!this.isReady) return;
    if (!this.playing && this.time >= this.end) this.seek(this.begin);
    this.playing = !this.playing;
    this.controls.showPlaying(this.playing);
  }

  pause() {
    this.playing = false;
    this.controls.showPlaying(this.playing);
  }

  setSpeed(speed) {
    this.speed = speed;
    this.controls.speedSelect.value = String(speed);
  }

  setMode(mode) {
    this.mode = mode;
    this.controls.modes.querySelector(`[value=${mode}]`).checked = true;
    this.stages.forEach((stage) => stage.setMode(mode));
    this.#explain();
    this.dirty = true;
  }

  setFollow(follow) {
    this.follow = this.controls.followBox.checked = follow;
    this.dirty = true;
  }

  /** Draws springs so thick that a network looks like a body. */
  setThick(thick) {
    this.controls.thickBox.checked = thick;
    this.stages.forEach((stage) => stage.setThick(thick));
    this.dirty = true;
  }

  /** Shows bodies of voxels as surfaces. */
  setSkin(isOn) {
    this.controls.skinBox.checked = isOn;
    this.stages.forEach((stage) => stage.setSkin(isOn));
    this.#explain();
    this.dirty = true;
  }

  readTheme() {
    readPalette();
    this.traces.draw();
    this.stages.forEach((stage) => stage.readTheme());
    if (this.isReady) this.#explain();
    this.dirty = true;
  }

  /** Updates the legend of the colours and the note on the accuracy of the picture. */
  #explain() {
    const shown = this.stages.filter((stage) => stage.life.shots.length > 0);
    this.controls.legend.replaceChildren(...(shown.length > 0 ? legend(this.mode, shown, this.scale) : []));
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
    if (width === 0 || !this.isReady) return;
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
    requestAnimationFrame((next) => this.#tick(next)); // first, so that an error does not end all motion
    const passed = Math.min(0.1, (now - (this.last ?? now)) / 1000);
    this.last = now;
    if (this.playing) {
      this.seek(this.time + passed * this.speed);
      if (this.time >= this.end) this.pause();
    }
    if (this.dirty) this.draw();
  }
}

/** Whether a key belongs to the control that has the focus, and not to the viewer. */
function belongsTo(target, key) {
  const control = target.closest?.("input,select,textarea,button,summary,a");
  if (!control) return false;
  if (control.matches("select,textarea,input:not([type=range],[type=radio],[type=checkbox])")) return true;
  return key === " " || (key.startsWith("Arrow") && control.matches("[type=range],[type=radio]"));
}
