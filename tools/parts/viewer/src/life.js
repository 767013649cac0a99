// A robot's life: which masses and springs exist at a time, and where they are.
import { voxelsOf } from "./skin.js";
import { changed, integers, Positions, Values } from "./unpack.js";

const smoothing = 0.5; // s before and after a moment; averaged, so that the robot's steps do not shake the camera

export class Life {
  /** Unpacks the life of a robot from the page's data. Its way is measured in `direction`, if it is given. */
  static async of(robot, direction) {
    const life = new Life();
    const film = robot.film;
    life.robot = robot;
    life.massCount = film.masses ?? 0;
    life.massMaterials = film.shots.length ? await integers(film.mass_materials) : new Int32Array();
    life.ends = film.shots.length ? await integers(film.ends) : new Int32Array();
    life.shots = await life.#unpacked(film.shots);
    life.begin = life.shots[0]?.begin ?? 0;
    life.end = life.shots.at(-1)?.end ?? 0;
    life.#markArrivals();
    life.#follow();
    life.way = life.#way(direction);
    return life;
  }

  /** Unpacks shots. Each shot is stored as its differences from the shots before. */
  async #unpacked(packed) {
    const springCount = this.ends.length / 2;
    const materials = new Values(springCount);
    const rests = new Values(springCount);
    const stress = new Values(springCount);
    const positions = new Positions();
    const shots = [];
    for (const shot of packed) {
      const { name, times } = shot;
      const before = shots.at(-1) ?? { masses: new Int32Array(), springs: new Int32Array() };
      const masses = await changed(before.masses, shot.masses);
      const springs = await changed(before.springs, shot.springs);
      shots.push({
        name,
        times,
        begin: times[0],
        end: times.at(-1),
        masses,
        springs,
        materials: await materials.next(shot.materials, springs),
        restLengths: await rests.next(shot.rest_lengths, springs),
        stress: await stress.next(shot.stress, springs),
        positions: await positions.next(shot.positions, masses, times.length),
      });
    }
    return shots;
  }

  /** Finds the shot in which each spring first exists and, for each shot, which of its springs are new and which
   *  springs of the previous shot are gone. */
  #markArrivals() {
    this.cameWith = new Int32Array(this.ends.length / 2).fill(-1);
    let before = new Map();
    this.shots.forEach((shot, index) => {
      const now = new Map();
      shot.springs.forEach((spring, i) => {
        if (this.cameWith[spring] < 0) this.cameWith[spring] = index;
        now.set(spring, i);
      });
      shot.isNew = Uint8Array.from(shot.springs, (spring) => (index > 0 && !before.has(spring) ? 1 : 0));
      shot.came = shot.isNew.reduce((sum, isNew) => sum + isNew, 0);
      shot.gone = [...before].filter(([spring]) => !now.has(spring)).map(([, i]) => i);
      before = now;
    });
  }

  #voxels;

  /** The voxels of the body, as voxelsOf() returns them; found when they are first asked for. */
  get voxels() {
    return (this.#voxels ??= voxelsOf(this));
  }

  /** Computes the path of the mean position of all masses, and a smoothed path of the middle of their bounding box. */
  #follow() {
    const step = this.robot.film.step;
    this.path = this.shots.flatMap((shot) =>
      shot.times.map((time, frame) => {
        const n = shot.masses.length;
        const rows = [0, 1, 2].map((axis) => shot.positions.subarray((3 * frame + axis) * n, (3 * frame + axis + 1) * n));
        return {
          time,
          middle: rows.map((row) => (row.reduce((a, b) => a + b, 0) / n) * step),
          boxMiddle: rows.map((row) => rangeOf(row).reduce((a, b) => a + b) * 0.5 * step),
        };
      }),
    );
    let from = 0;
    let to = 0;
    this.smoothPath = this.path.map(({ time }) => {
      while (this.path[from].time < time - smoothing) ++from;
      while (to < this.path.length && this.path[to].time <= time + smoothing) ++to;
      const near = this.path.slice(from, to);
      const mean = (axis) => near.reduce((sum, { boxMiddle }) => sum + boxMiddle[axis], 0) / near.length;
      return { time, middle: [0, 1, 2].map(mean) };
    });
  }

  /** Returns how the robot moves in the shot in which its fitness is measured: where it is at the `begin` and its body
   *  `length` (m) there, the level unit vector `direction` of the fitness or, if that has none, that in which it has moved
   *  at the end, and the `total` way in that direction, in body lengths. Undefined if nothing is measured. */
  #way(given) {
    const index = this.shots.findIndex(({ name }) => name.startsWith("measured")); // the name also names a scenario
    if (index < 0) return undefined;
    const begin = this.path.findLast(({ time }) => time <= this.shots[index].begin);
    const length = this.boxIn(index).size;
    const moved = [0, 1].map((axis) => this.path.at(-1).middle[axis] - begin.middle[axis]);
    const [x, y] = given && Math.hypot(given[0], given[1]) > 0 ? given : moved;
    const norm = Math.hypot(x, y);
    const direction = norm > 0 ? [x / norm, y / norm] : [1, 0];
    return { begin, length, direction, total: (moved[0] * direction[0] + moved[1] * direction[1]) / length };
  }

  /** Returns how far the robot has moved in the direction of its way since the measurement began, m. */
  movedAt(time) {
    const { begin, direction } = this.way;
    const now = this.middleAt(time);
    return [0, 1].reduce((sum, axis) => sum + direction[axis] * (now[axis] - begin.middle[axis]), 0);
  }

  /** A mass that is shown at most this high above the ground is on it, m: positions are rounded to a multiple of a step. */
  get touch() {
    return 0.51 * this.robot.film.step;
  }

  /** Returns the index of the shot at a time. If one shot ends and the next begins then, it is the next one. */
  shotAt(time) {
    let index = this.shots.length - 1;
    while (index > 0 && this.shots[index].begin > time + 1e-9) --index;
    return index;
  }

  /** Returns the stress of the i-th spring of a shot, N; null if none was recorded. */
  stressOf(shot, i) {
    const { most_stress, stress_levels } = this.robot.film;
    return shot.stress.length > 0 ? most_stress * (shot.stress[i] / stress_levels) ** 2 : null;
  }

  middleAt(time, path = this.path) {
    if (path.length === 0) return [0, 0, 0];
    const [i, part] = between(path.length, (k) => path[k].time, time);
    return path[i].middle.map((x, axis) => x + part * (path[Math.min(i + 1, path.length - 1)].middle[axis] - x));
  }

  /** Writes the positions (m) of all masses at a time, four numbers for each. Masses that have just been removed keep
  *  their last position. */
  writePositions(time, out) {
    const index = this.shotAt(time);
    if (index < 0) return;
    if (index > 0) this.#write(this.shots[index - 1], this.shots[index - 1].times.length - 1, 0, out);
    const shot = this.shots[index];
    const [frame, part] = between(shot.times.length, (k) => shot.times[k], time);
    this.#write(shot, frame, part, out);
  }

  #write(shot, frame, part, out) {
    const n = shot.masses.length;
    const step = this.robot.film.step;
    const next = Math.min(frame + 1, shot.times.length - 1);
    for (let axis = 0; axis < 3; ++axis) {
      const a = (3 * frame + axis) * n;
      const b = (3 * next + axis) * n;
      for (let i = 0; i < n; ++i)
        out[4 * shot.masses[i] + axis] = step * (shot.positions[a + i] * (1 - part) + shot.positions[b + i] * part);
    }
  }

  /** Returns the longest side and the middle of the body's bounding box at the beginning of a shot, m. */
  boxIn(index) {
    const shot = this.shots[index];
    if (!shot) return { size: 1, middle: [0, 0, 0] };
    const n = shot.masses.length;
    const step = this.robot.film.step;
    const ranges = [0, 1, 2].map((axis) =>
      rangeOf(shot.positions.subarray(axis * n, (axis + 1) * n)).map((bound) => bound * step),
    );
    return {
      size: Math.max(step, ...ranges.map(([low, high]) => high - low)),
      middle: ranges.map(([low, high]) => (low + high) / 2),
    };
  }
}

/** Returns the smallest and the largest of the numbers. */
function rangeOf(numbers) {
  let low = numbers[0];
  let high = low;
  for (const number of numbers) {
    if (number < low) low = number;
    if (number > high) high = number;
  }
  return [low, high];
}

/** Returns the last index whose time is not after `time`, and the elapsed fraction of the interval to the next index.
 *  */
function between(count, timeOf, time) {
  let low = 0;
  let high = count - 1;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (timeOf(middle) <= time) low = middle;
    else high = middle - 1;
  }
  const next = Math.min(low + 1, count - 1);
  const span = timeOf(next) - timeOf(low);
  return [low, span > 0 ? Math.min(1, Math.max(0, (time - timeOf(low)) / span)) : 0];
}
