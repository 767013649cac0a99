// Takes a film or a picture of a page of the viewer: node film.mjs PAGE.html OUT.mp4|OUT.png NAME_IN_MESSAGES [AT]
import { spawn } from "node:child_process";
import { once } from "node:events";
import { writeFile } from "node:fs/promises";
import { draw, ffmpegProgram, launch, opened } from "./browser.mjs";

const framesPerSecond = 30;
const viewport = { width: 1280, height: 720 };

function encoder(out) {
  const input = ["-f", "image2pipe", "-framerate", String(framesPerSecond), "-i", "-"];
  const output = ["-c:v", "libx264", "-preset", "veryfast", "-pix_fmt", "yuv420p", "-crf", "20", "-movflags", "+faststart", out];
  const ffmpeg = spawn(ffmpegProgram(), ["-y", "-loglevel", "error", ...input, ...output], {
    stdio: ["pipe", "inherit", "inherit"],
  });
  ffmpeg.stdin.on("error", () => {}); // its exit code says it
  return { ffmpeg, closed: once(ffmpeg, "close") };
}

async function film(tab, out) {
  const { begin, end } = await tab.evaluate(async () => {
    const { viewer } = await window.evodevo;
    return { begin: viewer.begin, end: viewer.end };
  });
  const { ffmpeg, closed } = encoder(out);
  const camera = await tab.context().newCDPSession(tab); // Playwright's own pictures take longer
  const frames = Math.round((end - begin) * framesPerSecond);
  const started = performance.now();
  try {
    for (let i = 0; i <= frames; ++i) {
      await draw(tab, begin + i / framesPerSecond);
      const picture = { format: "jpeg", quality: 95, optimizeForSpeed: true };
      const { data } = await camera.send("Page.captureScreenshot", picture);
      if (!ffmpeg.stdin.write(Buffer.from(data, "base64"))) await Promise.race([once(ffmpeg.stdin, "drain"), closed]);
      if (process.stderr.isTTY) process.stderr.write(`\r${i + 1} of ${frames + 1} frames${i === frames ? "\n" : ""}`);
    }
  } finally {
    ffmpeg.stdin.end(); // it would keep this process alive
  }
  if ((await closed)[0] !== 0) throw new Error("ffmpeg failed");
  const rate = (1000 * (frames + 1)) / (performance.now() - started);
  console.error(`evodevo: ${frames + 1} frames, ${rate.toPrecision(2)} a second`);
}

async function still(tab, out, at) {
  const { end, middle } = await tab.evaluate(async () => {
    const { viewer } = await window.evodevo;
    return { end: viewer.end, middle: (viewer.stages[0].life.shots.at(-1).begin + viewer.end) / 2 };
  });
  if (at < 0 || at > end) throw new Error(`--at ${at}: expected a moment of the life, 0 to ${end} s`);
  const moment = at ?? middle;
  await draw(tab, moment);
  await writeFile(out, await ((await tab.$(".gallery")) ?? tab).screenshot());
}

const [page, out, name, at] = process.argv.slice(2);
try {
  const browser = await launch();
  try {
    const tab = await opened(browser, page, { viewport }, { hash: "#film" });
    if (out.endsWith(".png")) await still(tab, out, at === undefined ? undefined : Number(at));
    else await film(tab, out);
  } finally {
    await browser.close();
  }
} catch (error) {
  console.error(`evodevo: ${name}: ${error.message}`);
  process.exitCode = 1;
}
