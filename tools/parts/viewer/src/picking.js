// Finds the mass or the spring under the pointer, and says what it is.
import * as THREE from "three";
import { element, short } from "./elements.js";

const reach = { mass: 8, spring: 5 }; // pixels

/** Returns the distance of a point from a segment, in pixels, and the part of the segment that is before the point. */
function fromSegment([x, y], [ax, ay], [bx, by]) {
  const [u, v] = [bx - ax, by - ay];
  const part = Math.min(1, Math.max(0, ((x - ax) * u + (y - ay) * v) / (u * u + v * v || 1)));
  return [Math.hypot(x - ax - part * u, y - ay - part * v), part];
}

/** Returns what is at a place of a picture of a stage: {mass} or {spring}, numbers of the life, or undefined. Of several
 *  springs it is the one in front. `place` and `size` are in pixels. */
export function pick(stage, camera, place, size) {
  const { life } = stage;
  if (life.shots.length === 0) return undefined;
  const shot = life.shots[stage.shown];
  const places = stage.positions.image.data;
  const toScreen = (mass) => {
    const at = new THREE.Vector3().fromArray(places, 4 * mass).applyMatrix4(stage.scene.matrixWorld).project(camera);
    return [((1 + at.x) / 2) * size[0], ((1 - at.y) / 2) * size[1], at.z];
  };
  const seen = new Map(Array.from(shot.masses, (mass) => [mass, toScreen(mass)]));
  const nearest = { distance: reach.mass };
  for (const [mass, [x, y]] of seen) {
    const distance = Math.hypot(x - place[0], y - place[1]);
    if (distance < nearest.distance) Object.assign(nearest, { distance, mass });
  }
  if (nearest.mass !== undefined) return { mass: nearest.mass };
  const front = { depth: Infinity };
  for (const spring of shot.springs) {
    const [a, b] = [0, 1].map((end) => seen.get(life.ends[2 * spring + end]));
    const [distance, part] = fromSegment(place, a, b);
    const depth = a[2] + part * (b[2] - a[2]);
    if (distance < reach.spring && depth < front.depth) Object.assign(front, { depth, spring });
  }
  return front.spring === undefined ? undefined : { spring: front.spring };
}

/** Describes a mass or a spring that was picked, at a time [s], and shows the stress of a spring in each cycle. */
export function described({ life, materialNames }, { mass, spring }, time) {
  const index = life.shotAt(time);
  const shot = life.shots[index];
  const places = new Float32Array(4 * life.massCount);
  life.writePositions(time, places);
  const at = (number) => Array.from(places.subarray(4 * number, 4 * number + 3));
  if (mass !== undefined) {
    if (!shot.masses.includes(mass)) return [`Mass ${mass} is not there at this time.`];
    const degree = shot.springs.reduce((sum, one) => sum + [0, 1].filter((end) => life.ends[2 * one + end] === mass).length, 0);
    return [`Mass ${mass}: ${degree} springs; at ${at(mass).map((x) => x.toFixed(3)).join(", ")} m.`];
  }
  const place = shot.springs.indexOf(spring);
  const [a, b] = [life.ends[2 * spring], life.ends[2 * spring + 1]];
  if (place < 0) return [`The spring between masses ${a} and ${b} is not there at this time.`];
  const made = life.robot.film.materials[shot.materials[place]];
  const name = materialNames[shot.materials[place]] ?? "a mixture or changed material";
  const [p, q] = [at(a), at(b)];
  const length = Math.hypot(...p.map((x, axis) => x - q[axis]));
  const muscle = made.amplitude > 0 ? `, amplitude ${short(made.amplitude)}, ${short(made.frequency)} Hz` : "";
  const came = life.cameWith[spring] > 0 ? `came after ${life.shots[life.cameWith[spring] - 1].name}` : "there from birth";
  const text = `Spring between masses ${a} and ${b}: ${name} (${short(made.stiffness)} N/m${muscle}); ${length.toFixed(3)} m long; ${came}.`;
  return [text, ...stressOf(life, spring, index)];
}

/** Returns the stress (N) of a spring in each cycle, as bars with the numbers; nothing if it was not recorded. */
function stressOf(life, spring, now) {
  const places = life.shots.map((shot) => shot.springs.indexOf(spring));
  const values = places.map((place, i) => (place < 0 ? null : life.stressOf(life.shots[i], place)));
  const texts = values.map((value, i) => (places[i] < 0 ? "not there" : value === null ? "not known" : `${short(value)} N`));
  const most = Math.max(...values);
  if (!(most > 0)) return [];
  const bar = (value, i) =>
    element("i", {
      style: `height:${value === null ? 0 : Math.max(1, (22 * value) / most)}px`,
      className: i === now ? "now" : "",
      title: `${life.shots[i].name}: ${texts[i]}`,
    });
  const label = `stress from ${life.shots[0].name} to ${life.shots.at(-1).name}: ${texts.join(", ")}`;
  return [
    element("span", { className: "stresses", role: "img", "aria-label": label }, ...values.map(bar)),
    element("span", { textContent: `stress of each cycle; ${texts[now]} in this one` }),
  ];
}
