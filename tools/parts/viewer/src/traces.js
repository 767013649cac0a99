// What a picked spring or mass does over the life, as a chart with a marker at the moment that is shown.
import { Chart, line } from "./chart.js";
import { runColour } from "./colours.js";
import { element, short } from "./elements.js";
import { titled } from "./scores.js";

/** Joins what a life has in each shot to columns over time [s]; of() returns pairs of a time and a value in a shot, or
 *  undefined if what is asked for is not there. Such shots have no values, so that lines have gaps there. */
function overShots(life, of) {
  const points = life.shots.flatMap((shot) => of(shot) ?? [[shot.begin, null], [shot.end, null]]);
  return [0, 1].map((column) => points.map((point) => point[column]));
}

/** Returns the place of the i-th mass of a shot in a frame, m. */
const placeIn = ({ robot }, { masses, positions }, frame, i) =>
  [0, 1, 2].map((axis) => robot.film.step * positions[(3 * frame + axis) * masses.length + i]);

const distance = (a, b) => Math.hypot(...a.map((x, axis) => x - b[axis]));

/** Returns the times [s] that the page holds, and at each the force of a spring without its dashpot, N: above 0 it pulls. */
export function forceOf(life, spring) {
  const { film } = life.robot;
  return overShots(life, (shot) => {
    const i = shot.springs.indexOf(spring);
    if (i < 0) return undefined;
    const { stiffness, amplitude, frequency, phase } = film.materials[shot.materials[i]];
    const rest = film.rest_step * shot.restLengths[i];
    const [a, b] = [0, 1].map((end) => shot.masses.indexOf(life.ends[2 * spring + end]));
    return shot.times.map((time, frame) => {
      const length = distance(placeIn(life, shot, frame, a), placeIn(life, shot, frame, b));
      return [time, stiffness * (length - rest * (1 + amplitude * Math.sin(2 * Math.PI * frequency * time + phase)))];
    });
  });
}

const factorError = 2 ** (1 / 32) - 1; // the page holds the stiffness factors of springs in steps of 2^(1/16)

/** How far the force of a spring can be off, N: each position is rounded to the nearest step along each axis, and the
 *  rest length to its own. A material without a name may be that of a stiffness factor, which is rounded, too. */
export function forceError({ life, materialNames }, spring) {
  const { film } = life.robot;
  const used = life.shots.map((shot) => shot.materials[shot.springs.indexOf(spring)]);
  const stiffness = used.map((material) => film.materials[material]?.stiffness ?? 0);
  const rounding = Math.max(...stiffness) * (Math.sqrt(3) * film.step + film.rest_step);
  if (!used.some((material) => material >= materialNames.length)) return rounding;
  const [, forces] = forceOf(life, spring);
  return rounding + factorError * forces.reduce((most, force) => Math.max(most, Math.abs(force ?? 0)), 0);
}

const force = { name: "force", unit: "N" };
const motions = [
  { name: "speed", unit: "m/s", of: speedOf },
  { name: "height", unit: "m", of: heightOf },
];

/** Returns the mean speed of a mass between two times that the page holds, m/s, in the middle between them. */
export function speedOf(life, mass) {
  return overShots(life, (shot) => {
    const i = shot.masses.indexOf(mass);
    if (i < 0) return undefined;
    return shot.times.slice(1).map((time, before) => {
      const passed = time - shot.times[before];
      const way = distance(placeIn(life, shot, before, i), placeIn(life, shot, before + 1, i));
      return [time - passed / 2, passed > 0 ? way / passed : null];
    });
  });
}

/** Returns the height of a mass at the times that the page holds, its coordinate z, m. */
export function heightOf(life, mass) {
  return overShots(life, (shot) => {
    const i = shot.masses.indexOf(mass);
    return i < 0 ? undefined : shot.times.map((time, frame) => [time, placeIn(life, shot, frame, i)[2]]);
  });
}

export class Traces {
  constructor() {
    this.time = 0;
    this.marker = element("div", { className: "moment" });
    this.force = new Chart("force", "Force of a spring", () => this.#described(this.#forceText(), forceOf, force));
    this.motion = new Chart(
      "motion",
      "Motion of a mass",
      (quantity) => this.#described(this.#motionText(quantity), quantity.of, quantity),
      [{ label: "Quantity", scores: motions, first: motions[0] }],
    );
    this.note = element("p", { className: "note" });
    this.root = element("div", { className: "traces", hidden: true });
  }

  /** Shows what was picked, {stage, mass} or {stage, spring}; nothing if it is undefined. */
  show(pick) {
    if (this.pick === pick) return;
    this.pick = pick;
    this.root.hidden = pick === undefined;
    this.root.replaceChildren();
    this.draw();
  }

  draw() {
    if (!this.pick) return;
    const isSpring = this.pick.spring !== undefined;
    const chart = isSpring ? this.force : this.motion;
    this.root.replaceChildren(chart.root, this.note);
    this.note.textContent = isSpring ? this.#forceNote() : "At the times that the page holds.";
    chart.draw();
  }

  /** Moves the marker to a time [s]. */
  seek(time) {
    this.time = time;
    this.#mark();
  }

  #mark() {
    const chart = this.pick?.spring === undefined ? this.motion : this.force;
    const { plot } = chart;
    if (!this.pick || !plot) return;
    if (this.marker.parentNode !== plot.over) plot.over.append(this.marker);
    const { min, max } = plot.scales.x;
    this.marker.hidden = !(this.time >= min && this.time <= max);
    this.marker.style.left = `${plot.valToPos(this.time, "x")}px`;
  }

  #described(title, of, quantity) {
    const { stage, mass, spring } = this.pick;
    return {
      title,
      data: of(stage.life, spring ?? mass),
      series: [{ ...line(quantity.name, runColour(0)), spanGaps: false }],
      x: "time (s)",
      y: titled(quantity),
      options: { hooks: { draw: [() => this.#mark()] } },
    };
  }

  #forceText() {
    const { stage, spring } = this.pick;
    const [a, b] = [0, 1].map((end) => stage.life.ends[2 * spring + end]);
    return `Force of the spring between masses ${a} and ${b}`;
  }

  #motionText({ name }) {
    return `${name === "speed" ? "Speed" : "Height"} of mass ${this.pick.mass}`;
  }

  #forceNote() {
    const { stage, spring } = this.pick;
    const { life } = stage;
    this.error = forceError(stage, spring);
    const hasDashpot = life.robot.film.materials.some(({ damping }) => damping > 0);
    const what = `Above 0 the spring pulls. At the times that the page holds, to within ${short(this.error)} N`;
    return `${what}${hasDashpot ? ", without the force of dashpots" : ""}.`;
  }
}
