// Small pictures of many robots, all drawn by one renderer.
import * as THREE from "three";
import { counted, element, short } from "./elements.js";
import { Life } from "./life.js";
import { Stage } from "./stage.js";

const side = 480; // pixels; twice the size at which pictures are shown

export class Gallery {
  constructor(robots, viewer) {
    this.robots = robots;
    this.pictures = robots.map(() => element("canvas", { width: side, height: side }));
    this.texts = robots.map(({ robot }) => element("span", { textContent: robot.reason }));
    const tile = ({ robot, label }, i) =>
      element(
        "button",
        {
          type: "button",
          className: "tile",
          onclick: () => viewer.open(i).then(() => viewer.toggle()),
        },
        this.pictures[i],
        element("span", { textContent: label }),
        this.texts[i],
      );
    this.root = element("section", { className: "gallery" }, this.#title(), ...robots.map(tile));
  }

  /** Says what the robots are, also in a picture without the page: the experiment, the seed, and how many are invalid. */
  #title() {
    const [{ run }] = this.robots;
    const invalid = this.robots.filter(({ robot }) => robot.film.shots.length === 0).length;
    const text = `${run.experiment} · seed ${run.seed} · ${counted(this.robots.length, "random robot")}, ${invalid} invalid`;
    return element("p", { className: "sheet-title", textContent: text });
  }

  /** Draws every robot at the end of its life. */
  async draw() {
    const canvas = element("canvas");
    const renderer = new THREE.WebGLRenderer({ canvas, antialias: true, alpha: true, preserveDrawingBuffer: true });
    renderer.outputColorSpace = THREE.LinearSRGBColorSpace;
    renderer.setSize(side, side, false);
    for (const [i, { robot, run }] of this.robots.entries()) {
      if (robot.film.shots.length === 0) continue;
      const stage = new Stage(await Life.of(robot), run);
      stage.seek(stage.life.end, true);
      const { size, middle } = stage.life.boxIn(stage.life.shots.length - 1);
      stage.lookAt(middle);
      this.texts[i].textContent = facts(stage.life, size);
      const camera = new THREE.PerspectiveCamera(30, 1, 0.01, 100);
      camera.up.set(0, 0, 1);
      camera.position
        .set(0.55, -1, 0.5)
        .normalize()
        .multiplyScalar(2.6 * size)
        .add(stage.target);
      camera.lookAt(stage.target);
      stage.draw(renderer, camera, side);
      const picture = this.pictures[i].getContext("2d");
      picture.clearRect(0, 0, side, side);
      picture.drawImage(canvas, 0, 0);
      stage.dispose();
    }
    renderer.dispose();
    renderer.forceContextLoss();
  }
}

/** Returns the size of a body, the numbers of its masses and springs, and that of the materials that its springs have. */
function facts({ shots }, size) {
  const { masses, springs, materials } = shots.at(-1);
  const numbers = [counted(masses.length, "mass", "masses"), counted(springs.length, "spring")];
  return [`${short(size)} m`, ...numbers, counted(new Set(materials).size, "material")].join(", ");
}
