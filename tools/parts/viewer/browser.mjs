// Starts a headless browser, which draws pages without a display.
import { accessSync, constants, readFileSync, realpathSync, statSync } from "node:fs";
import { delimiter, isAbsolute, join } from "node:path";
import { pathToFileURL } from "node:url";
import { chromium } from "playwright-core";

function isThere(path) {
  try {
    accessSync(path, constants.X_OK);
    return true;
  } catch {
    return false;
  }
}

/** Returns the paths at which programs with these names exist in PATH. */
function programs(names) {
  const folders = (process.env.PATH ?? "").split(delimiter);
  return names.flatMap((name) => folders.map((folder) => join(folder, name))).filter(isThere);
}

/** Whether a program is a snap, or a script that asks the user to install one, as in Ubuntu's package chromium-browser.
 *  A snap cannot read the pages, which lie in the folder for temporary files. */
function isSnap(path) {
  const target = realpathSync(path);
  if (target.includes("/snap")) return true;
  return statSync(target).size < 10_000 && readFileSync(target, "utf8").includes("snap install");
}

export function ffmpegProgram() {
  const [found] = programs(["ffmpeg"]);
  if (!found) throw new Error("this needs ffmpeg, which is not there (Debian and Ubuntu: apt-get install ffmpeg)");
  return found;
}

export function chromiumProgram() {
  if (process.env.EVODEVO_CHROMIUM) return process.env.EVODEVO_CHROMIUM;
  const found = programs(["chromium", "chromium-browser", "google-chrome"]).find((path) => !isSnap(path));
  if (found) return found;
  throw new Error(
    "this needs Chromium, which is not there (Debian: apt-get install chromium; Ubuntu has it as a snap alone, which " +
      "cannot read the pages: install Google Chrome, or set EVODEVO_CHROMIUM to the program of any Chromium)",
  );
}

/** This process's environment without HOME and XDG folders whose paths are not absolute: Chromium would write into a
*  relative HOME. */
function environment() {
  const means = ([name, value]) => !/^(HOME|XDG_[A-Z]+_HOME)$/.test(name) || isAbsolute(value);
  return Object.fromEntries(Object.entries(process.env).filter(means));
}

/** Starts Chromium. `more` holds additional switches, which override those below. */
export const launch = async (more = []) =>
  chromium.launch({
    executablePath: chromiumProgram(),
    env: environment(),
    chromiumSandbox: false, // the sandbox does not work for root or in many containers; we open only our own pages
    // Mesa draws with a GPU or without one. Without a GPU it is twice as fast as SwiftShader, which Chromium brings
    // along and uses if there is no Mesa.
    args: ["--use-gl=angle", "--use-angle=gl-egl", "--ignore-gpu-blocklist", "--enable-unsafe-swiftshader", ...more],
  });

/** How long a page may take to load from its file, ms. On a busy machine without a GPU, loading can take minutes. */
export const patience = 300_000;

/** Waits for what a page does, of which a browser that draws no frames would never come to the end. Throws if it takes
 *  longer than `patience`. */
export async function inTime(answer) {
  let timer;
  const late = new Promise((_, reject) => {
    timer = setTimeout(() => reject(new Error(`the browser has not answered for ${patience / 1000} s`)), patience);
  });
  return Promise.race([answer, late]).finally(() => clearTimeout(timer));
}

/** Opens a page of the viewer and waits until it is ready. `options` are those of Playwright's newPage; the page runs
 *  the function `before` before its own code. */
export async function opened(browser, file, options, { hash = "", before } = {}) {
  const tab = await browser.newPage({ reducedMotion: "reduce", ...options }); // it does not play by itself
  if (before) await tab.addInitScript(before);
  tab.on("pageerror", (error) => console.error(`evodevo: the page says: ${error.message}`));
  await tab.goto(pathToFileURL(file) + hash, { timeout: patience });
  await inTime(tab.evaluate(async () => void (await window.evodevo)));
  return tab;
}

/** Draws the page at a time of the life [s]. */
export async function draw(tab, time) {
  const drawn = tab.evaluate(async (at) => {
    const { viewer } = await window.evodevo;
    viewer.seek(at);
    viewer.draw();
    await new Promise((done) => requestAnimationFrame(done));
  }, time);
  await inTime(drawn);
}
