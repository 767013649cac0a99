// Small pictures of many robots, all drawn by one renderer.
import * as THREE from "three";
import { element } from "./elements.js";
import { Life } from "./life.js";
import { Stage } from "./stage.js";

const side = 480; // pixels; twice the size at which pictures are shown

export class Gallery {
  constructor(robots, viewer) {
    this.robots = robots;
    this.pictures = robots.map(() => element("canvas", { width: side, height: side }));
    const tile = ({ robot, label }, i) =>
      element(
        "button",
        {
          type: "button",
          className: "tile",
          onclick: () => viewer.open(i).then(() => viewer.toggle()),
        },
        this.pictures[i],
        element("span", { textContent: robot.film.shots.length > 0 ? label : robot.reason }),
      );
    this.root = element("section", { className: "gallery" }, ...robots.map(tile));
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
