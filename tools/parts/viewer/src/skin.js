// The skin of a body of voxels: their outer faces.

const bits = [0, 1, 2, 3, 4, 5, 6, 7]; // of a corner: 1, 2 and 4 say on which side along x, y and z it is
const most = 28; // pairs of corners of a voxel

/** Returns the voxels of a life: cubes of eight masses whose four body diagonals are springs at birth. Only these pairs
 *  of masses belong to one voxel alone. Each voxel has its `corners`, masses in the order of `bits`; the `springs` that
 *  ever join two of them, in a list for each pair, since springs may act in parallel; the diagonals `inside`; and the
 *  indices of its `neighbours`, two for each axis, -1 where there is none. */
export function voxelsOf(life) {
  const shot = life.shots.find(({ springs }) => springs.length > 0);
  if (!shot) return [];
  const n = shot.masses.length;
  const placeOf = new Map(Array.from(shot.masses, (mass, i) => [mass, [0, 1, 2].map((axis) => shot.positions[axis * n + i])]));
  const diagonals = Array.from(shot.springs, (spring) => diagonal(life, placeOf, spring)).filter((one) => one !== undefined);
  const shortest = Math.min(...diagonals.map(({ edge }) => edge));
  const cubes = diagonals.filter(({ edge }) => edge < 1.1 * shortest + 2);
  const edge = cubes.reduce((sum, one) => sum + one.edge, 0) / cubes.length;
  const keyOf = (place) => place.map((x, axis) => Math.round((x - cubes[0].low[axis]) / edge)).join();
  const massAt = new Map(cubes.length > 0 ? [...placeOf].map(([mass, place]) => [keyOf(place), mass]) : []);
  const inside = new Map(); // the diagonals of each cube
  for (const { low, spring } of cubes) {
    const key = keyOf(low);
    inside.set(key, [...(inside.get(key) ?? []), spring]);
  }
  const springsOf = springsByEnds(life);
  const voxels = [...inside]
    .map(([key, springs]) => ({ key, at: key.split(",").map(Number), inside: springs }))
    .map((one) => ({ ...one, corners: bits.map((corner) => massAt.get(moved(one.at, corner).join())) }))
    .filter(({ inside: springs, corners }) => springs.length === 4 && !corners.includes(undefined));
  const indexOf = new Map(voxels.map(({ key }, i) => [key, i]));
  return voxels.map(({ at, inside: own, corners }) => ({
    corners,
    inside: own,
    springs: corners.flatMap((a, i) => corners.slice(0, i).map((b) => springsOf(a, b))).filter((parallel) => parallel.length > 0),
    neighbours: [0, 1, 2].flatMap((axis) => [-1, 1].map((by) => indexOf.get(at.map((x, k) => (k === axis ? x + by : x)).join()) ?? -1)),
  }));
}

/** Returns the lowest corner and the edge of the cube of which a spring is a body diagonal, in steps of the film;
 *  undefined if it is none. */
function diagonal(life, placeOf, spring) {
  const [a, b] = [0, 1].map((end) => placeOf.get(life.ends[2 * spring + end]));
  const sides = a.map((x, axis) => Math.abs(x - b[axis]));
  const [least, greatest] = [Math.min(...sides), Math.max(...sides)];
  if (least === 0 || greatest - least > 2 + 0.01 * greatest) return undefined;
  return { spring, low: a.map((x, axis) => Math.min(x, b[axis])), edge: (sides[0] + sides[1] + sides[2]) / 3 };
}

const moved = (at, corner) => at.map((x, axis) => x + ((corner >> axis) & 1));

/** Returns a function that finds springs by the masses that they join. */
function springsByEnds({ ends, massCount }) {
  const key = (a, b) => Math.min(a, b) * massCount + Math.max(a, b);
  const springs = new Map();
  for (let spring = 0; 2 * spring < ends.length; ++spring) {
    const pair = key(ends[2 * spring], ends[2 * spring + 1]);
    springs.set(pair, [...(springs.get(pair) ?? []), spring]);
  }
  return (a, b) => springs.get(key(a, b)) ?? [];
}

/** Returns the skin in a shot: the four corners of each face, going round it, and its colour; and for each spring of the
 *  life whether it is `covered` by a voxel. A voxel is there as long as its masses are, and springs join more than half
 *  of its pairs of corners. Its faces have the mean colour of the diagonals inside it or, if these are gone, of its other
 *  springs. */
export function skinOf(life, shot, colourOf) {
  const placeOf = new Int32Array(life.ends.length / 2).fill(-1);
  shot.springs.forEach((spring, i) => (placeOf[spring] = i));
  const isThere = new Uint8Array(life.massCount);
  shot.masses.forEach((mass) => (isThere[mass] = 1));
  const present = (springs) => springs.filter((spring) => placeOf[spring] >= 0);
  const joined = (springs) => springs.filter((parallel) => present(parallel).length > 0).length;
  const shown = life.voxels.map(
    ({ corners, springs }) => 2 * joined(springs) > most && corners.every((mass) => isThere[mass]),
  );
  const skin = { corners: [], colours: [], covered: new Uint8Array(placeOf.length) };
  life.voxels.forEach((voxel, i) => {
    if (!shown[i]) return;
    for (const spring of voxel.springs.flat()) skin.covered[spring] = 1;
    const open = sides.filter((_, side) => !shown[voxel.neighbours[side]]);
    if (open.length === 0) return;
    const inside = present(voxel.inside);
    const colour = meanOf((inside.length > 0 ? inside : present(voxel.springs.flat())).map((spring) => colourOf(shot, placeOf[spring])));
    for (const side of open) {
      skin.corners.push(...side.map((corner) => voxel.corners[corner]));
      skin.colours.push(...colour);
    }
  });
  return skin;
}

/** The corners of each side of a voxel, going round it, in the order of `neighbours`. */
const sides = [0, 1, 2].flatMap((axis) =>
  [0, 1].map((high) => {
    const [u, v] = [1 << ((axis + 1) % 3), 1 << ((axis + 2) % 3)];
    return [0, u, u | v, v].map((corner) => corner | (high << axis));
  }),
);

const meanOf = (colours) => [0, 1, 2].map((k) => colours.reduce((sum, colour) => sum + colour[k], 0) / colours.length);
