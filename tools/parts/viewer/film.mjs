// Makes a film or a picture of a page of the viewer:
//   node film.mjs PAGE.html OUT.mp4|OUT.gif|OUT.webp|OUT.png NAME_IN_MESSAGES [--at S | --from S --to S] [--quiet]
import { execFileSync, spawn } from "node:child_process";
import { once } from "node:events";
import { writeFile } from "node:fs/promises";
import { extname } from "node:path";
import { parseArgs } from "node:util";
import { draw, ffmpegProgram, launch, opened } from "./browser.mjs";

const viewport = { width: 1280, height: 720 };

// Frames are drawn larger and scaled down, which smooths edges. "area" makes smaller files than sharper filters.
const small = "scale=480:-1:flags=area";

/** The ffmpeg options for each file extension. `-loop 0` repeats the film for ever. */
const formats = {
  ".mp4": {
    encoder: "libx264",
    framesPerSecond: 30,
    output: ["-preset", "veryfast", "-pix_fmt", "yuv420p", "-crf", "20", "-movflags", "+faststart"],
  },
  ".gif": {
    encoder: "gif",
    framesPerSecond: 20,
    // One palette of 32 colours for all frames, chosen from the pixels that change. Dithering is off, since it
    // compresses badly. A frame takes 30 KB; with 96 colours it would take one and a half times as much.
    output: [
      "-vf",
      `${small},split[a][b];[a]palettegen=max_colors=32:stats_mode=diff[p];[b][p]paletteuse=dither=none`,
      "-loop",
      "0",
    ],
  },
  ".webp": {
    encoder: "libwebp_anim",
    framesPerSecond: 20,
    output: ["-vf", small, "-quality", "60", "-compression_level", "6", "-loop", "0"],
  },
};

/** Throws an error if this ffmpeg was built without the encoder. */
function expectEncoder(name, ending) {
  const listed = execFileSync(ffmpegProgram(), ["-hide_banner", "-encoders"], { encoding: "utf8" });
  if (listed.split("\n").some((line) => line.trim().split(/\s+/)[1] === name)) return;
  const others = Object.keys(formats).filter((other) => other !== ending).join(" or ");
  throw new Error(`this ffmpeg was built without ${name}; install one with it, or give --out a name ending in ${others}`);
}

function encoder(out, { encoder, framesPerSecond, output }) {
  const input = ["-f", "image2pipe", "-framerate", String(framesPerSecond), "-i", "-"];
  const ffmpeg = spawn(ffmpegProgram(), ["-y", "-loglevel", "error", ...input, "-c:v", encoder, ...output, out], {
    stdio: ["pipe", "inherit", "inherit"],
  });
  ffmpeg.stdin.on("error", () => {}); // the exit code reports the failure
  return { ffmpeg, closed: once(ffmpeg, "close") };
}

function expectMoment(option, moment, end) {
  if (moment < 0 || moment > end) throw new Error(`--${option} ${moment}: expected a time of the life, 0 to ${end} s`);
}

/** Returns a time as minutes and seconds, such as "2:05". */
const minutes = (seconds) => `${Math.floor(seconds / 60)}:${String(Math.floor(seconds % 60)).padStart(2, "0")}`;

/** Shows on a terminal how many frames there are of how many, and how long the others will take. */
function showProgress(done, all, started) {
  const left = ((performance.now() - started) / 1000 / done) * (all - done);
  process.stderr.write(`\r${done} of ${all} frames, ${minutes(left)} left \x1b[K${done === all ? "\n" : ""}`);
}

/** Returns the moments at which the life that the page shows begins and ends and, for a picture, the middle of its last
 *  part [s]. */
async function momentsOf(tab) {
  const moments = await tab.evaluate(async () => {
    const { viewer } = await window.evodevo;
    const last = viewer?.stages[0].life.shots.at(-1);
    return last && { begin: viewer.begin, end: viewer.end, middle: (last.begin + viewer.end) / 2 };
  });
  if (!moments) throw new Error("there is nothing to draw: the robot never lived, or the browser has no WebGL");
  return moments;
}

async function film(tab, out, { from, to, quiet }) {
  const life = await momentsOf(tab);
  const begin = from ?? life.begin;
  const end = to ?? life.end;
  expectMoment("from", begin, life.end);
  expectMoment("to", end, life.end);
  const format = formats[extname(out)];
  expectEncoder(format.encoder, extname(out));
  const { ffmpeg, closed } = encoder(out, format);
  const camera = await tab.context().newCDPSession(tab); // faster than Playwright's screenshots
  const frames = Math.round((end - begin) * format.framesPerSecond);
  const started = performance.now();
  try {
    for (let i = 0; i <= frames; ++i) {
      await draw(tab, begin + i / format.framesPerSecond);
      const picture = { format: "jpeg", quality: 95, optimizeForSpeed: true };
      const { data } = await camera.send("Page.captureScreenshot", picture);
      if (!ffmpeg.stdin.write(Buffer.from(data, "base64"))) await Promise.race([once(ffmpeg.stdin, "drain"), closed]);
      if (process.stderr.isTTY && !quiet) showProgress(i + 1, frames + 1, started);
    }
  } finally {
    ffmpeg.stdin.end(); // an open pipe would keep this process alive
  }
  if ((await closed)[0] !== 0) throw new Error("ffmpeg failed");
  const rate = (1000 * (frames + 1)) / (performance.now() - started);
  if (!quiet) console.error(`evodevo: ${frames + 1} frames, ${rate.toPrecision(2)} a second`);
}

async function still(tab, out, at) {
  const gallery = await tab.$(".gallery"); // which the page has drawn already
  if (!gallery) {
    const { end, middle } = await momentsOf(tab);
    const moment = at ?? middle;
    expectMoment("at", moment, end);
    await draw(tab, moment);
  }
  await writeFile(out, await (gallery ?? tab).screenshot());
}

const text = { type: "string" };
const { positionals, values } = parseArgs({
  allowPositionals: true,
  options: { at: text, from: text, to: text, quiet: { type: "boolean" } },
});
const [page, out, name] = positionals;
const moment = (value) => (value === undefined ? undefined : Number(value));
try {
  const browser = await launch();
  try {
    const tab = await opened(browser, page, { viewport }, { hash: "#film" });
    if (out.endsWith(".png")) await still(tab, out, moment(values.at));
    else await film(tab, out, { from: moment(values.from), to: moment(values.to), quiet: values.quiet });
  } finally {
    await browser.close();
  }
} catch (error) {
  console.error(`evodevo: ${name}: ${error.message}`);
  process.exitCode = 1;
}
