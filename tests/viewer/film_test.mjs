// Films, pictures and the gallery.
import assert from "node:assert/strict";
import { execFileSync, spawnSync } from "node:child_process";
import { existsSync, mkdirSync, readdirSync, readFileSync, rmdirSync, symlinkSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { chromiumProgram, cycles, cycleTime, differing, evodevo, inPage, launch, opened, picture, Scratch, sum } from "./support.mjs";

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

test("a film shows the whole life at 30 frames a second", { skip: hasFfmpeg ? false : "there is no ffmpeg" }, () => {
  const out = scratch.path("film.mp4");
  evodevo("film", scratch.run, "--individual", "0", "--out", out);
  const probed = execFileSync(
    "ffprobe",
    [
      "-v",
      "error",
      "-count_frames",
      "-show_entries",
      "stream=width,height,nb_read_frames,r_frame_rate",
      "-of",
      "json",
      out,
    ],
    { encoding: "utf8" },
  );
  const [stream] = JSON.parse(probed).streams;
  const duration = cycles * cycleTime + 0.5 + 1.0;
  assert.deepEqual(
    [stream.width, stream.height, stream.r_frame_rate, Number(stream.nb_read_frames)],
    [1280, 720, "30/1", 30 * duration + 1],
  );
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
  const refusal = (at, out) => {
    const arguments_ = ["film", scratch.run, "--at", at, "--out", scratch.path(out)];
    const { status, stderr } = spawnSync(process.env.EVODEVO_PROGRAM, arguments_, { encoding: "utf8" });
    assert.notEqual(status, 0);
    return stderr;
  };
  assert.match(refusal("500", "late.png"), /^evodevo: .*late\.png: --at 500: expected a moment of the life, 0 to [\d.]+ s$/m);
  assert.doesNotMatch(refusal("500", "late.png"), /^\s+at /m);
  for (const [moment, named] of [["nan", "not a number"], ["inf", "infinity"], ["-0.5", "-0.5"]])
    assert.match(refusal(moment, "never.png"), new RegExp(`^evodevo: --at ${named}: expected a moment since birth`));
  assert.match(refusal("1", "film.gif"), /^evodevo: --out .*film\.gif: expected a name ending in \.mp4 or \.png\n$/);
  assert.match(refusal("1", "still.mp4"), /^evodevo: --at is the moment of a picture/);
});

test("a gallery shows as many robots as asked for, and how balls become bodies", async () => {
  const file = scratch.path("gallery.html");
  evodevo("gallery", scratch.file, "--count", "5", "--out", file);
  const page = await opened(browser, file);
  assert.equal(await page.locator(".tile").count(), 5);
  assert.deepEqual(page.complaints, []);
  const far = await inPage(page, ({ viewer }) => {
    const { life } = viewer.stages[0];
    const all = new Float32Array(4 * life.massCount);
    life.writePlaces(0, all);
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

test("a gallery can be a picture", () => {
  evodevo("gallery", scratch.file, "--count", "3", "--out", scratch.path("gallery.png"));
  const [width, height] = sizeOf(scratch.path("gallery.png"));
  assert.ok(width === 1280 && height > 100);
});
