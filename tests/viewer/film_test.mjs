// Films, pictures and the gallery.
import assert from "node:assert/strict";
import { execFileSync, spawnSync } from "node:child_process";
import { existsSync, mkdirSync, readdirSync, readFileSync, symlinkSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { before, test } from "node:test";
import { barrenRun, chromiumProgram, closed, cycleTime, differing, evodevo, experimentName, inPage, opened, picture, ran, scratch, sum } from "./support.mjs";

const duration = cycleTime + 0.25 + 0.25;

before(() => ran("run", ["development.cycles=1", "fitness.0.settle=0.25", "fitness.0.window=0.25", "experiment.verify=0"]));

/** What `evodevo film` says about a robot of a run, and its exit code. */
const filmed = (options, run = scratch.run, more = {}) =>
  spawnSync(process.env.EVODEVO_PROGRAM, ["film", run, ...options], { encoding: "utf8", ...more });

/** Width and height of a PNG. */
function sizeOf(file) {
  const bytes = readFileSync(file);
  assert.equal(bytes.subarray(1, 4).toString(), "PNG");
  return [bytes.readUInt32BE(16), bytes.readUInt32BE(20)];
}

const hasFfmpeg = (process.env.PATH ?? "").split(":").some((folder) => existsSync(`${folder}/ffmpeg`));
const withFfmpeg = { skip: hasFfmpeg ? false : "there is no ffmpeg" };

/** Width, height, frame rate and number of frames of a film, by ffprobe. */
function probed(file) {
  const entries = "stream=width,height,nb_read_frames,r_frame_rate";
  const options = ["-v", "error", "-count_frames", "-show_entries", entries, "-of", "json", file];
  const [stream] = JSON.parse(execFileSync("ffprobe", options, { encoding: "utf8" })).streams;
  return [stream.width, stream.height, stream.r_frame_rate, Number(stream.nb_read_frames)];
}

test("a film shows the whole life at 30 frames a second", withFfmpeg, () => {
  const out = scratch.path("film.mp4");
  evodevo("film", scratch.run, "--individual", "0", "--out", out);
  assert.deepEqual(probed(out), [1280, 720, "30/1", 30 * duration + 1]);
});

test("a GIF of a part of a life is small, has 20 frames a second and repeats; quiet, it says its name alone", withFfmpeg, () => {
  const out = scratch.path("film.gif");
  const { stdout, stderr } = filmed(["--from", "0.25", "--to", "0.75", "--out", out, "--quiet"]);
  assert.deepEqual([stdout, stderr], [`${out}\n`, ""]);
  assert.deepEqual(probed(out), [480, 270, "20/1", 11]);
  assert.ok(readFileSync(out).includes("NETSCAPE2.0\x03\x01\x00\x00", "latin1"), "it does not repeat for ever");
});

/** The chunks of a WebP file: their names and where their data begins. */
function* chunksOf(bytes) {
  assert.equal(bytes.subarray(0, 4).toString() + bytes.subarray(8, 12).toString(), "RIFFWEBP");
  for (let at = 12; at < bytes.length; at += 8 + 2 * Math.ceil(bytes.readUInt32LE(at + 4) / 2))
    yield { name: bytes.subarray(at, at + 4).toString(), at: at + 8 };
}

const hasWebp = hasFfmpeg && execFileSync("ffmpeg", ["-hide_banner", "-encoders"], { encoding: "utf8" }).includes("libwebp_anim");

test("a WebP is small, moves and repeats", { skip: hasWebp ? false : "there is no ffmpeg with libwebp" }, () => {
  const out = scratch.path("film.webp");
  evodevo("film", scratch.run, "--from", "0.25", "--to", "0.75", "--out", out);
  const bytes = readFileSync(out);
  const chunks = [...chunksOf(bytes)];
  const { at } = chunks.find(({ name }) => name === "VP8X");
  assert.deepEqual([bytes.readUIntLE(at + 4, 3) + 1, bytes.readUIntLE(at + 7, 3) + 1], [480, 270]);
  const frames = chunks.filter(({ name }) => name === "ANMF");
  const shown = frames.reduce((time, frame) => time + bytes.readUIntLE(frame.at + 12, 3), 0);
  assert.ok(frames.length > 5 && Math.abs(shown - 11 * 50) <= 50, `${frames.length} frames in ${shown} ms`);
  assert.equal(bytes.readUInt16LE(chunks.find(({ name }) => name === "ANIM").at + 4), 0, "it does not repeat for ever");
});

test("an ffmpeg without the encoder is named before anything is drawn", () => {
  const tools = scratch.path("tools");
  mkdirSync(tools);
  const log = scratch.path("ffmpeg.log");
  writeFileSync(join(tools, "ffmpeg"), `#!/bin/sh\necho "$@" >>'${log}'\necho ' V....D libx264 H.264'\n`, { mode: 0o755 });
  const env = { ...process.env, PATH: `${tools}:${process.env.PATH}` };
  const { status, stderr } = filmed(["--out", scratch.path("no.webp")], scratch.run, { env });
  assert.equal(status, 1);
  assert.match(stderr, /no\.webp: .*libwebp_anim.*\.mp4 or \.gif/);
  assert.equal(readFileSync(log, "utf8"), "-hide_banner -encoders\n");
});

test("pictures of two moments differ, and nothing but them is written, wherever home is", () => {
  const pictures = [["", "--at", "0"], [".", "--at", "0.7"], ["home"]].map(([home, ...moment], i) => {
    const [cwd, out] = [scratch.path(`here-${i}`), scratch.path(`${i}.png`)];
    mkdirSync(cwd);
    filmed([...moment, "--out", out], scratch.run, { cwd, env: { ...process.env, HOME: home, XDG_CACHE_HOME: "cache" } });
    assert.deepEqual(readdirSync(cwd), []);
    assert.deepEqual(sizeOf(out), [1280, 720]);
    return readFileSync(out);
  });
  assert.notDeepEqual(pictures[0], pictures[1]);
});

test("what cannot be filmed is refused in one line", () => {
  for (const [said, out, ...options] of [
    [/^evodevo: .*late\.png: --at 500: .*0 to [\d.]+ s$/m, "late.png", "--at", "500"],
    [/^evodevo: .*late\.mp4: --to 500: .*0 to [\d.]+ s$/m, "late.mp4", "--to", "500"],
    [/^evodevo: --at not a number: .*0 s or later/, "never.png", "--at", "nan"],
    [/^evodevo: --at infinity: .*0 s or later/, "never.png", "--at", "inf"],
    [/^evodevo: --at -0.5: .*0 s or later/, "never.png", "--at", "-0.5"],
    [/^evodevo: --out .*film\.avi: .*\.mp4, \.gif, \.webp, \.png\n$/, "film.avi"],
    [/^evodevo: --at 1: .*\.png/, "still.mp4", "--at", "1"],
    [/^evodevo: --from .*--at/, "still.png", "--from", "1"],
    [/^evodevo: --to 1: .*--from 2/, "back.mp4", "--from", "2", "--to", "1"],
  ]) {
    const { status, stderr } = filmed([...options, "--out", scratch.path(out)]);
    assert.notEqual(status, 0);
    assert.match(stderr, said);
    assert.doesNotMatch(stderr, /^\s+at /m);
  }
});

test("a gallery shows as many robots as asked for, and how balls become bodies", async () => {
  const file = scratch.path("gallery.html");
  evodevo("gallery", scratch.file, "--count", "5", "--out", file);
  const page = await opened(file);
  assert.equal(await page.locator(".tile").count(), 5);
  const shown = await inPage(page, ({ gallery, viewer }) =>
    gallery.texts.map(({ textContent }, i) => [textContent, viewer.robots[i].robot.film.shots.length > 0]),
  );
  const invalid = shown.filter(([, isBody]) => !isBody).length;
  const title = `${experimentName} · seed 3 · 5 random robots, ${invalid} invalid`;
  assert.equal(await page.locator(".sheet-title").textContent(), title);
  for (const [text, isBody] of shown) {
    if (!isBody) continue;
    const [, size, masses] = /^([\d.]+) m, (\d+) masses, \d+ springs, \d+ materials?$/.exec(text);
    assert.ok(Number(size) > 0 && Number(masses) > 3 && Number(masses) <= 40, text); // of 40 points
  }
  const far = await inPage(page, ({ viewer }) => {
    const { life } = viewer.stages[0];
    const all = new Float32Array(4 * life.massCount);
    life.writePositions(0, all);
    return Math.max(...Array.from({ length: life.massCount }, (_, i) => Math.hypot(...all.slice(4 * i, 4 * i + 3))));
  });
  assert.ok(far <= 1.001 && far > 0.7, `points of the unit ball lie up to ${far} m away`);
  const ball = await picture(page);
  await inPage(page, ({ viewer }) => viewer.seek(2.5));
  assert.ok(sum(await differing(ball, await picture(page))) > 200);
  await closed(page);
});

test("a snap, which could not read the pages, is no browser", () => {
  const { PATH, EVODEVO_CHROMIUM } = process.env;
  const [asking, snap, real] = ["asking", "snap/bin", "real"].map((name) => scratch.path(name));
  for (const folder of [asking, snap, real]) mkdirSync(folder, { recursive: true });
  const program = (path, text) => writeFileSync(path, text, { mode: 0o755 });
  program(join(asking, "chromium-browser"), "#!/bin/sh\necho 'Please install it: snap install chromium'\nexit 1\n");
  program(join(snap, "started"), "");
  symlinkSync(join(snap, "started"), join(asking, "chromium"));
  program(join(real, "google-chrome"), "");
  try {
    delete process.env.EVODEVO_CHROMIUM;
    process.env.PATH = asking;
    assert.throws(chromiumProgram, /Ubuntu.*EVODEVO_CHROMIUM/);
    process.env.PATH = `${asking}:${real}`;
    assert.equal(chromiumProgram(), join(real, "google-chrome"));
  } finally {
    process.env.PATH = PATH;
    if (EVODEVO_CHROMIUM !== undefined) process.env.EVODEVO_CHROMIUM = EVODEVO_CHROMIUM;
  }
});

test("a gallery can be a picture; a robot that never lived cannot be filmed, and is left out of that picture", () => {
  const { run, file, soft } = barrenRun();
  const png = ["--out", scratch.path("none.png")], mp4 = ["--out", scratch.path("none.mp4")];
  for (const options of [["--at", "1", ...png], png, mp4]) {
    const { status, stderr } = filmed(["--individual", "0", ...options], run);
    assert.notEqual(status, 0);
    assert.match(stderr, /^evodevo: .*none\.(png|mp4): there is nothing to draw: the robot never lived/m);
  }
  for (const [name, ...experiment] of [["gallery.png", scratch.file], ["barren.png", file, ...soft]]) {
    evodevo("gallery", ...experiment, "--count", "3", "--out", scratch.path(name));
    const [width, height] = sizeOf(scratch.path(name));
    assert.ok(width === 1280 && (name === "barren.png" || height > 100), `${name}: ${width} by ${height}`);
  }
});
