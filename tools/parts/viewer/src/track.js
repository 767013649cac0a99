// The way of a robot since its measurement began: the line at which it started, an arrow in the direction in which it
// has moved at the end, a mark after each body length, and the trail of its centre.
import * as THREE from "three";
import { style } from "./elements.js";

const mostMarks = 60;

/** Returns triangles that form a level strip of a width along points. */
function strip(points, width) {
  const positions = new Float32Array(6 * points.length);
  points.forEach(([x, y, z], i) => {
    const [a, b] = [points[Math.max(0, i - 1)], points[Math.min(points.length - 1, i + 1)]];
    const part = width / 2 / (Math.hypot(b[0] - a[0], b[1] - a[1]) || 1);
    const [u, v] = [-(b[1] - a[1]) * part, (b[0] - a[0]) * part];
    positions.set([x + u, y + v, z, x - u, y - v, z], 6 * i);
  });
  const triangles = points.slice(1).flatMap((_, i) => [0, 1, 2, 1, 3, 2].map((k) => 2 * i + k));
  return geometryOf(positions, triangles);
}

function geometryOf(positions, triangles) {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(positions), 3));
  geometry.setIndex(triangles);
  return geometry;
}

export class Track {
  /** Creates the track of a life. `heightAt` returns the height of the ground at x and y, m; it is undefined in water,
   *  where the trail is at the height of the robot. */
  constructor(life, heightAt) {
    this.life = life;
    this.root = new THREE.Group();
    this.lines = this.#material();
    this.trailColour = this.#material();
    const { begin, direction, length, total } = life.way;
    const [across, along] = [[-direction[1], direction[0]], direction];
    const lift = 0.01 * length; // above the ground, so that it does not hide the track
    const at = (forward, aside) => {
      const [x, y] = [0, 1].map((axis) => begin.middle[axis] + forward * along[axis] + aside * across[axis]);
      return [x, y, heightAt ? heightAt(x, y) + lift : begin.middle[2]];
    };
    const steps = [-1, -0.5, 0, 0.5, 1];
    const crossing = (forward, half, width) => strip(steps.map((step) => at(forward, step * half)), width);
    this.#add(crossing(0, 0.8 * length, 0.03 * length), this.lines);
    for (let mark = 1; mark <= Math.min(mostMarks, total + 1e-3); ++mark)
      this.#add(crossing(mark * length, 0.25 * length, 0.012 * length), this.lines);
    const arrow = [at(0.3 * length, 0), at(0.08 * length, 0.1 * length), at(0.08 * length, -0.1 * length)];
    this.#add(geometryOf(arrow.flat(), [0, 1, 2]), this.lines);
    this.path = life.path.slice(life.path.indexOf(begin));
    const trail = this.path.map(({ middle: [x, y, z] }) => [x, y, heightAt ? heightAt(x, y) + 0.5 * lift : z]);
    this.trail = this.#add(strip(trail, 0.02 * length), this.trailColour);
    this.readTheme();
  }

  #material() {
    return new THREE.MeshBasicMaterial({ transparent: true, depthWrite: false, side: THREE.DoubleSide });
  }

  #add(geometry, material) {
    const mesh = new THREE.Mesh(geometry, material);
    mesh.frustumCulled = false;
    mesh.renderOrder = 0.5; // on the floor, below shadows
    this.root.add(mesh);
    return mesh;
  }

  readTheme() {
    this.lines.color.setStyle(style("--soft"), THREE.LinearSRGBColorSpace);
    this.trailColour.color.setStyle(style("--accent"), THREE.LinearSRGBColorSpace);
  }

  /** Shows the trail up to a time [s]. */
  seek(time) {
    const passed = this.path.findLastIndex((point) => point.time <= time + 1e-9);
    this.trail.geometry.setDrawRange(0, 6 * Math.max(0, passed));
  }
}
