// The headless browser that draws pages without a display.
import { accessSync, constants } from "node:fs";
import { delimiter, join } from "node:path";
import { pathToFileURL } from "node:url";
import { chromium } from "playwright-core";

/** The path of the first of these programs that is there. */
export function program(names) {
  const folders = (process.env.PATH ?? "").split(delimiter);
  for (const path of names.flatMap((name) => folders.map((folder) => join(folder, name)))) {
    try {
      accessSync(path, constants.X_OK);
      return path;
    } catch {
      // the next one
    }
  }
  throw new Error(`this needs ${names[0]}, which is not there (Debian: apt-get install ${names[0]})`);
}

export const launch = async () =>
  chromium.launch({
    executablePath: process.env.EVODEVO_CHROMIUM ?? program(["chromium", "chromium-browser", "google-chrome"]),
    // Mesa draws, by a GPU or without one, then twice as fast as Chromium's own SwiftShader, which steps in where there
    // is no Mesa; root, as in a container, has no sandbox
    args: [
      "--use-gl=angle",
      "--use-angle=gl-egl",
      "--ignore-gpu-blocklist",
      "--enable-unsafe-swiftshader",
      ...(process.getuid?.() === 0 ? ["--no-sandbox"] : []),
    ],
  });

/** A page of the viewer, ready. `options` are Playwright's; `before` is what the page does first. */
export async function opened(browser, file, options, { hash = "", before } = {}) {
  const tab = await browser.newPage(options);
  if (before) await tab.addInitScript(before);
  tab.on("pageerror", (error) => console.error(`evodevo: the page says: ${error.message}`));
  await tab.goto(pathToFileURL(file) + hash);
  await tab.evaluate(async () => void (await window.evodevo));
  return tab;
}

/** Draws a moment. */
export async function draw(tab, time) {
  await tab.evaluate(async (at) => {
    const { viewer } = await window.evodevo;
    viewer.seek(at);
    viewer.draw();
    await new Promise((done) => requestAnimationFrame(done));
  }, time);
}
