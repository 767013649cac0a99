// Takes a film or a picture of a page of the viewer: node film.mjs PAGE.html OUT.mp4|OUT.png [AT]
import { spawn } from "node:child_process";
import { once } from "node:events";
import { accessSync, constants } from "node:fs";
import { delimiter, join } from "node:path";
import { pathToFileURL } from "node:url";
import { chromium } from "playwright-core";

const framesPerSecond = 30;
const size = { width: 1280, height: 720 };

function fail(message) {
  console.error(`evodevo: ${message}`);
  process.exit(1);
}

/** The path of the first of these programs that is there. */
function program(names) {
  const folders = (process.env.PATH ?? "").split(delimiter);
  for (const path of names.flatMap((name) => folders.map((folder) => join(folder, name)))) {
    try {
      accessSync(path, constants.X_OK);
      return path;
    } catch {
      // the next one
    }
  }
  return fail(`films need ${names[0]}, which is not there (Debian: apt-get install ${names[0]})`);
}

async function opened(browser, page) {
  const tab = await browser.newPage({ viewport: size });
  tab.on("pageerror", (error) => fail(`the page fails: ${error.message}`));
  await tab.goto(`${pathToFileURL(page)}#film`);
  await tab.evaluate(async () => void (await window.evodevo));
  return tab;
}

/** Draws a moment and takes a picture of it. */
async function picture(tab, time) {
  await tab.evaluate(async (at) => {
    const { viewer } = await window.evodevo;
    viewer.seek(at);
    await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
  }, time);
  return tab.screenshot();
}

async function film(tab, out) {
  const { begin, end } = await tab.evaluate(async () => {
    const { viewer } = await window.evodevo;
    return { begin: viewer.begin, end: viewer.end };
  });
  const encoder = spawn(program(["ffmpeg"]), ["-y", "-loglevel", "error", "-f", "image2pipe", "-framerate", String(framesPerSecond), "-i", "-", "-c:v", "libx264", "-pix_fmt", "yuv420p", "-crf", "20", "-movflags", "+faststart", out], { stdio: ["pipe", "inherit", "inherit"] });
  const closed = once(encoder, "close");
  encoder.stdin.on("error", () => {}); // its exit code says it
  const frames = Math.round((end - begin) * framesPerSecond);
  for (let i = 0; i <= frames; ++i)
    if (!encoder.stdin.write(await picture(tab, begin + i / framesPerSecond))) await Promise.race([once(encoder.stdin, "drain"), closed]);
  encoder.stdin.end();
  if ((await closed)[0] !== 0) fail(`${out}: ffmpeg failed`);
}

async function still(tab, out, at) {
  const { writeFile } = await import("node:fs/promises");
  const moment = await tab.evaluate(async (asked) => {
    const { viewer } = await window.evodevo;
    return asked ?? (viewer.stages[0].life.shots.at(-1).begin + viewer.end) / 2;
  }, at);
  const image = await picture(tab, moment);
  const gallery = await tab.$(".gallery");
  await writeFile(out, gallery ? await gallery.screenshot() : image);
}

const [page, out, at] = process.argv.slice(2);
const browser = await chromium.launch({
  executablePath: process.env.EVODEVO_CHROMIUM ?? program(["chromium", "chromium-browser", "google-chrome"]),
  // without a display and a GPU; a container's root has no sandbox
  args: ["--use-angle=swiftshader", "--enable-unsafe-swiftshader", ...(process.getuid?.() === 0 ? ["--no-sandbox"] : [])],
});
try {
  const tab = await opened(browser, page);
  if (out.endsWith(".png")) await still(tab, out, at === undefined ? undefined : Number(at));
  else await film(tab, out);
} catch (error) {
  fail(`${out}: ${error.message}`);
} finally {
  await browser.close();
}
