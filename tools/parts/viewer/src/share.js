// What leaves the page: files, and a link to the robots, the moment and the camera that are shown.
import { element } from "./elements.js";

/** Saves a file. `content` is a text or a Blob. */
export function save(name, content) {
  const url = URL.createObjectURL(content instanceof Blob ? content : new Blob([content]));
  element("a", { href: url, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(url), 10_000); // when the browser has begun to read it
}

/** Returns rows as CSV. Texts are quoted where they have to be. */
export function csv(rows) {
  const quoted = (value) => (/[",\n]/.test(value) ? `"${value.replaceAll('"', '""')}"` : value);
  return rows.map((row) => row.map((value) => quoted(String(value ?? ""))).join(",") + "\n").join("");
}

/** Returns a word of a command line for a shell. */
export const shellWord = (text) => (/^[\w./+-]+$/.test(text) ? text : `'${text.replaceAll("'", `'\\''`)}'`);

/** Returns a name for a file about something, with only those characters that every file system allows. */
export const fileName = (text, ending) => `${text.replace(/[^\p{L}\p{N}.,_-]+/gu, "-").replace(/^-+|-+$/g, "")}.${ending}`;

/** Returns the name of a robot for files; if it has had several lives, with the number of the one shown. */
export const robotName = ({ individual, life, lived }) => `individual-${individual}${lived > 1 ? `-life-${life}` : ""}`;

/** Returns the visible body of a life at a time [s], as JSON: positions (m), and of each spring the masses that it joins,
 *  by their places in `masses`, its material and its stress (N) in the cycle. */
export function bodyJson(life, time) {
  const shot = life.shots[life.shotAt(time)];
  const { materials } = life.robot.film;
  const all = new Float32Array(4 * life.massCount);
  life.writePositions(time, all);
  const rounded = (x) => (x === null ? null : Number(x.toPrecision(6)));
  const masses = Array.from(shot.masses, (mass) => Array.from(all.subarray(4 * mass, 4 * mass + 3), rounded));
  const placeOf = new Map(Array.from(shot.masses, (mass, i) => [mass, i]));
  const springs = Array.from(shot.springs, (spring, i) => ({
    masses: [placeOf.get(life.ends[2 * spring]), placeOf.get(life.ends[2 * spring + 1])],
    material: shot.materials[i],
    stress: rounded(life.stressOf(shot, i)),
  }));
  return JSON.stringify({ individual: life.robot.individual, time, materials, masses, springs }, null, 1);
}

/** Returns the hash of a link to what a viewer shows. */
export function linkTo(viewer) {
  const [first, second] = viewer.chosen;
  const camera = viewer.camera.position.toArray();
  const values = {
    robot: first,
    ...(second === undefined ? {} : { beside: second }),
    time: viewer.time.toFixed(3),
    colour: viewer.mode,
    view: viewer.view,
    camera: [...camera, ...viewer.orbit.target.toArray()].map((x) => x.toPrecision(5)).join(","),
  };
  return `#${new URLSearchParams(values)}`;
}

/** Returns what a link says, {robot, beside, time, colour, view, camera}, or undefined if the hash is not a link's. */
export function linked(hash, robots) {
  const values = new URLSearchParams(hash.slice(1));
  const number = (name) => (values.has(name) ? Number(values.get(name)) : undefined);
  const isRobot = (i) => Number.isInteger(i) && i >= 0 && i < robots.length;
  const robot = number("robot");
  if (!isRobot(robot)) return undefined;
  const camera = (values.get("camera") ?? "").split(",").map(Number);
  const isPlace = camera.length === 6 && camera.every(Number.isFinite);
  return {
    robot,
    beside: isRobot(number("beside")) ? number("beside") : undefined,
    time: number("time"),
    colour: values.get("colour"),
    view: values.get("view"),
    camera: isPlace ? camera : undefined,
  };
}
