// Unpacks data packed by framework/report/packing.cpp.

/** Returns the integers in a packed text. */
export async function integers(text) {
  const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  const plain = new Uint8Array(await new Response(stream).arrayBuffer());
  const numbers = new Int32Array(plain.reduce((count, byte) => count + (byte < 0x80 ? 1 : 0), 0));
  let at = 0;
  for (let i = 0; i < numbers.length; ++i) {
    let value = 0;
    let shift = 0;
    do ((value |= (plain[at] & 0x7f) << shift), (shift += 7));
    while (plain[at++] >= 0x80);
    numbers[i] = (value >>> 1) ^ -(value & 1);
  }
  return numbers;
}

/** Returns numbers that are packed as differences between neighbours. */
export async function sums(text) {
  const numbers = await integers(text);
  for (let i = 1; i < numbers.length; ++i) numbers[i] += numbers[i - 1];
  return numbers;
}

/** Returns an ascending list of numbers. `before` is the previous list; the packed text holds the numbers that were
 *  added or removed. */
export async function changed(before, text) {
  const changes = new Set(await sums(text));
  return Int32Array.from([...before.filter((number) => !changes.delete(number)), ...changes]).sort();
}

/** Unpacks one value for each item of each shot. Values are packed as differences from the last value of the same item.
 *  */
export class Values {
  constructor(count) {
    this.last = new Int32Array(count);
  }

  /** Returns the values of the items with these numbers; an empty array if the text holds no values. */
  async next(text, numbers) {
    const values = await integers(text);
    for (let i = 0; i < values.length; ++i) values[i] = this.last[numbers[i]] += values[i];
    return values;
  }
}

/** Unpacks positions shot by shot, as multiples of the film's step: for each frame all x, then all y, then all z. */
export class Positions {
  #last = new Map(); // the last x, y and z of each mass that has existed

  async next(text, masses, frames) {
    const all = await integers(text);
    const size = 3 * masses.length;
    for (let i = 0; i < Math.min(size, all.length); ++i) {
      const mass = i % masses.length;
      const known = this.#last.get(masses[mass]);
      all[i] += known ? known[Math.floor(i / masses.length)] : mass > 0 ? all[i - 1] : 0;
    }
    for (let i = size; i < frames * size; ++i) {
      const last = all[i - size];
      all[i] += last + (i < 2 * size ? 0 : (last - all[i - 2 * size]) >> 1);
    }
    const end = all.subarray((frames - 1) * size);
    masses.forEach((mass, i) => this.#last.set(mass, [0, 1, 2].map((axis) => end[axis * masses.length + i])));
    return all;
  }
}
