// Opens a page of the viewer in Chromium, and prints the errors and warnings in its console: open_page.mjs VIEWER FILE.
// The exit status is 1 if there are any. With "chromium" instead of a file, only looks whether there is a Chromium.
import { join } from "node:path";
import { pathToFileURL } from "node:url";

const [viewer, file] = process.argv.slice(2);
const { chromiumProgram, launch, patience } = await import(pathToFileURL(join(viewer, "browser.mjs")).href);
if (file === "chromium") {
  chromiumProgram();
  process.exit(0);
}

const complaints = [];
const browser = await launch();
try {
  const tab = await browser.newPage({ reducedMotion: "reduce" });
  tab.on("pageerror", (error) => complaints.push(error.message));
  tab.on("console", (message) => {
    const [type, text] = [message.type(), message.text()];
    // a renderer's messages about its own speed are not errors of the page
    if (["error", "warning"].includes(type) && !text.includes("GL Driver Message (OpenGL, Performance,"))
      complaints.push(`${type}: ${text}`);
  });
  await tab.goto(pathToFileURL(file).href, { timeout: patience });
  await tab.evaluate(async () => {
    const { viewer: shown } = await window.evodevo; // which a page without robots lacks
    shown?.draw();
    await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
  });
} catch (error) {
  complaints.push(error.message);
} finally {
  await browser.close();
}
for (const complaint of complaints) console.log(complaint);
process.exit(complaints.length > 0 ? 1 : 0);
