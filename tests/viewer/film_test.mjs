// Films, pictures and the gallery.
import assert from "node:assert/strict";
import { execFileSync, spawnSync } from "node:child_process";
import { existsSync, mkdirSync, readdirSync, readFileSync, rmdirSync, symlinkSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { barrenRun, chromiumProgram, cycles, cycleTime, differing, evodevo, experimentName, inPage, launch, opened, picture, Scratch, sum } from "./support.mjs";

const scratch = new Scratch();
let browser;

before(async () => {
  evodevo("run", scratch.file, "--out", scratch.run);
  browser = await launch();
});
after(async () => {
  await browser?.close();
  scratch.remove();
});

/** Width and height of a PNG. */
function sizeOf(file) {
  const bytes = readFileSync(file);
  assert.equal(bytes.subarray(1, 4).toString(), "PNG");
  return [bytes.readUInt32BE(16), bytes.readUInt32BE(20)];
}

const hasFfmpeg = (process.env.PATH ?? "").split(":").some((folder) => existsSync(`${folder}/ffmpeg`));

const withFfmpeg = { skip: hasFfmpeg ? false : "there is no ffmpeg" };
const duration = cycles * cycleTime + 0.5 + 1.0;

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

test("a film can begin and end amid a life", withFfmpeg, () => {
  const out = scratch.path("part.mp4");
  evodevo("film", scratch.run, "--from", "1.5", "--to", "2", "--out", out);
  assert.deepEqual(probed(out), [1280, 720, "30/1", 30 * 0.5 + 1]);
});

test("a GIF is small, has 20 frames a second and repeats", withFfmpeg, () => {
  const out = scratch.path("film.gif");
  evodevo("film", scratch.run, "--from", "2", "--to", "3", "--out", out);
  assert.deepEqual(probed(out), [480, 270, "20/1", 21]);
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
  evodevo("film", scratch.run, "--from", "2", "--to", "3", "--out", out);
  const bytes = readFileSync(out);
  const chunks = [...chunksOf(bytes)];
  const { at } = chunks.find(({ name }) => name === "VP8X");
  assert.deepEqual([bytes.readUIntLE(at + 4, 3) + 1, bytes.readUIntLE(at + 7, 3) + 1], [480, 270]);
  const frames = chunks.filter(({ name }) => name === "ANMF");
  const shown = frames.reduce((time, frame) => time + bytes.readUIntLE(frame.at + 12, 3), 0);
  assert.ok(frames.length > 10 && Math.abs(shown - 21 * 50) <= 50, `${frames.length} frames in ${shown} ms`);
  assert.equal(bytes.readUInt16LE(chunks.find(({ name }) => name === "ANIM").at + 4), 0, "it does not repeat for ever");
});

test("an ffmpeg without the encoder is named before anything is drawn", () => {
  const tools = scratch.path("tools");
  mkdirSync(tools);
  const log = scratch.path("ffmpeg.log");
  writeFileSync(join(tools, "ffmpeg"), `#!/bin/sh\necho "$@" >>'${log}'\necho ' V....D libx264 H.264'\n`, { mode: 0o755 });
  const { status, stderr } = spawnSync(process.env.EVODEVO_PROGRAM, ["film", scratch.run, "--out", scratch.path("no.webp")], {
    encoding: "utf8",
    env: { ...process.env, PATH: `${tools}:${process.env.PATH}` },
  });
  assert.equal(status, 1);
  assert.match(stderr, /no\.webp: .*libwebp_anim.*\.mp4 or \.gif/);
  assert.equal(readFileSync(log, "utf8"), "-hide_banner -encoders\n");
});

test("quiet, a film says its name alone", withFfmpeg, () => {
  const out = scratch.path("quiet.gif");
  const arguments_ = ["film", scratch.run, "--to", "0.1", "--out", out, "--quiet"];
  const { stdout, stderr } = spawnSync(process.env.EVODEVO_PROGRAM, arguments_, { encoding: "utf8" });
  assert.deepEqual([stdout, stderr], [`${out}\n`, ""]);
});

test("pictures of two moments differ", () => {
  for (const at of ["0", "2"]) evodevo("film", scratch.run, "--at", at, "--out", scratch.path(`${at}.png`));
  assert.deepEqual(sizeOf(scratch.path("0.png")), [1280, 720]);
  assert.notDeepEqual(readFileSync(scratch.path("0.png")), readFileSync(scratch.path("2.png")));
});

test("nothing but the picture is written, wherever home is", () => {
  const here = scratch.path("here");
  for (const home of ["", ".", "home"]) {
    mkdirSync(here);
    const environment = { ...process.env, HOME: home, XDG_CACHE_HOME: "cache" };
    execFileSync(process.env.EVODEVO_PROGRAM, ["film", scratch.run, "--out", scratch.path("home.png")], {
      cwd: here,
      env: environment,
      stdio: "ignore",
    });
    assert.deepEqual(readdirSync(here), []);
    rmdirSync(here);
  }
});

test("what cannot be filmed is refused in one line", () => {
  const refusal = (out, ...options) => {
    const arguments_ = ["film", scratch.run, ...options, "--out", scratch.path(out)];
    const { status, stderr } = spawnSync(process.env.EVODEVO_PROGRAM, arguments_, { encoding: "utf8" });
    assert.notEqual(status, 0);
    return stderr;
  };
  assert.match(refusal("late.png", "--at", "500"), /^evodevo: .*late\.png: --at 500: .*0 to [\d.]+ s$/m);
  assert.doesNotMatch(refusal("late.png", "--at", "500"), /^\s+at /m);
  assert.match(refusal("late.mp4", "--to", "500"), /^evodevo: .*late\.mp4: --to 500: .*0 to [\d.]+ s$/m);
  for (const [moment, named] of [["nan", "not a number"], ["inf", "infinity"], ["-0.5", "-0.5"]])
    assert.match(refusal("never.png", "--at", moment), new RegExp(`^evodevo: --at ${named}: .*0 s or later`));
  assert.match(refusal("film.avi"), /^evodevo: --out .*film\.avi: .*\.mp4, \.gif, \.webp, \.png\n$/);
  assert.match(refusal("still.mp4", "--at", "1"), /^evodevo: --at 1: .*\.png/);
  assert.match(refusal("still.png", "--from", "1"), /^evodevo: --from .*--at/);
  assert.match(refusal("back.mp4", "--from", "2", "--to", "1"), /^evodevo: --to 1: .*--from 2/);
});

test("a gallery shows as many robots as asked for, and how balls become bodies", async () => {
  const file = scratch.path("gallery.html");
  evodevo("gallery", scratch.file, "--count", "5", "--out", file);
  const page = await opened(browser, file);
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
  assert.deepEqual(page.complaints, []);
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
  await page.close();
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

test("a robot that never lived cannot be filmed, and is left out of a gallery's picture", () => {
  const { run, file, soft } = barrenRun(scratch);
  for (const options of [["--out", "none.png"], ["--at", "1", "--out", "none.png"], ["--out", "none.mp4"]]) {
    const words = ["film", run, "--individual", "0", ...options.map((word) => (word.includes(".") ? scratch.path(word) : word))];
    const { status, stderr } = spawnSync(process.env.EVODEVO_PROGRAM, words, { encoding: "utf8" });
    assert.notEqual(status, 0);
    assert.match(stderr, /^evodevo: .*none\.(png|mp4): there is nothing to draw: the robot never lived/m);
  }
  evodevo("gallery", file, ...soft, "--count", "3", "--out", scratch.path("barren.png"));
  assert.equal(sizeOf(scratch.path("barren.png"))[0], 1280);
});

test("a gallery can be a picture", () => {
  evodevo("gallery", scratch.file, "--count", "3", "--out", scratch.path("gallery.png"));
  const [width, height] = sizeOf(scratch.path("gallery.png"));
  assert.ok(width === 1280 && height > 100);
});
