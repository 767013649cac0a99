// Undoes framework/report/packing.cpp.

/** The integers in a packed text. */
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

/** Numbers from the differences between them. */
export async function sums(text) {
  const numbers = await integers(text);
  for (let i = 1; i < numbers.length; ++i) numbers[i] += numbers[i - 1];
  return numbers;
}

/** Places in units of the step, frame by frame, in each all x, all y, all z. */
export async function places(text, masses, frames) {
  const numbers = await integers(text);
  const size = 3 * masses;
  for (let i = 0; i < Math.min(size, numbers.length); ++i) if (i % masses !== 0) numbers[i] += numbers[i - 1];
  for (let i = size; i < Math.min(2 * size, numbers.length); ++i) numbers[i] += numbers[i - size];
  for (let i = 2 * size; i < frames * size; ++i) numbers[i] += 2 * numbers[i - size] - numbers[i - 2 * size];
  return numbers;
}
