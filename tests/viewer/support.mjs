// Code that the tests of the page share: a small run, a browser, and functions that examine pictures.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after } from "node:test";
import { pathToFileURL } from "node:url";

export const { chromiumProgram, inTime, launch, patience } = await import(pathToFileURL(join(process.env.EVODEVO_VIEWER, "browser.mjs")).href);

/** Names that would be harmful if they were interpreted as markup. */
export const experimentName = `<img src=x onerror="window.harmed=1">`;
export const materialName = `</script><script>window.harmed=1</script>`;

export const cycles = 3;
export const cycleTime = 0.5;

const experiment = `
experiment = { seed = 3, evaluations = 48, population = 12 }
encoding = { name = "neural", points = 40, neighbours = 8 }
mutation = [{ name = "reset-weight" }]
scene = { gravity = {}, floor = {}, friction = {}, damping = {} }
simulation = { device = "cpu" }
selection = { name = "age-fitness-pareto" }
[materials.${JSON.stringify(materialName)}]
stiffness = 3000
[development]
draws = "individual"
cycles = ${cycles}
cycle_time = ${cycleTime}
operator = [{ name = "spring-turnover", springs = 6 }, { name = "mass-turnover", springs = 9 }]
[[fitness]]
name = "distance"
settle = 0.5
window = 1.0
`;

const folder = mkdtempSync(join(tmpdir(), "evodevo-viewer-"));
/** A folder with the experiment, for one file of tests. It and the browser are there until the tests have ended. */
export const scratch = {
  file: join(folder, `${experimentName}.toml`),
  run: join(folder, "run"),
  path: (name) => join(folder, name),
};
writeFileSync(scratch.file, experiment);

let browser;
after(async () => {
  rmSync(folder, { recursive: true });
  await (await browser)?.close();
});

export function evodevo(...words) {
  return execFileSync(process.env.EVODEVO_PROGRAM, words, { encoding: "utf8", maxBuffer: 1 << 28 });
}

/** Makes a run of an experiment in a folder with this name, which it returns. */
export function ran(name, settings = [], file = scratch.file) {
  evodevo("run", file, "--out", scratch.path(name), ...settings.flatMap((setting) => ["--set", setting]));
  return scratch.path(name);
}

let reports = 0;
/** Calls `evodevo report` with these words, and returns the page. */
export function reported(...words) {
  const page = scratch.path(`report-${++reports}.html`);
  evodevo("report", ...words, "--out", page);
  return page;
}

/** Makes a run of robots that never live, since they have no springs. Returns its folder, its experiment, and the options
 * that make the springs of the experiment's other materials vanish. */
export function barrenRun() {
  const file = scratch.path("barren.toml");
  writeFileSync(file, readFileSync(scratch.file, "utf8").replace("stiffness = 3000", "stiffness = 0"));
  const materials = ["muscle", "muscle2", "tissue", "bone"].map((name) => `materials.${name}.stiffness=0`);
  const soft = materials.flatMap((setting) => ["--set", setting]), run = scratch.path("barren");
  assert.throws(() => evodevo("run", file, "--out", run, ...soft), (error) => error.status === 3);
  return { run, file, soft };
}

/** Returns the result of an SQL query in a run's archive, without using evodevo. */
export function archived(folder, query) {
  const program =
    "import json,sqlite3,sys; db = sqlite3.connect(sys.argv[1]); print(json.dumps(db.execute(sys.argv[2]).fetchall())); db.commit()";
  return JSON.parse(execFileSync("python3", ["-c", program, join(folder, "run.sqlite"), query], { encoding: "utf8" }));
}

/** Writes a page with the data of another one, as changed by a function. */
export function writeChanged(from, to, change) {
  const data = /(?<=<script id="data" type="application\/json">).*?(?=<\/script>)/s;
  const changed = (json) => JSON.stringify(change(JSON.parse(json))).replaceAll("<", "\\u003c");
  writeFileSync(to, readFileSync(from, "utf8").replace(data, changed));
}

/** Opens a page from its file, in the browser of all tests unless another is given. It does not play by itself, unless
 *  `options` say that motion is welcome; keeps the page's requests in `requests`, and its errors and warnings in
 *  `complaints`. */
export async function opened(file, options = {}, { hash = "", before: hidden, within = (browser ??= launch()) } = {}) {
  const page = await (await within).newPage({ viewport: { width: 640, height: 600 }, reducedMotion: "reduce", ...options });
  page.requests = [];
  page.complaints = [];
  page.on("request", (request) => page.requests.push(request.url()));
  page.on("console", (message) => {
    // a renderer's messages about its own speed are not errors of the page
    if (!message.text().includes("GL Driver Message (OpenGL, Performance,"))
      page.complaints.push(`${message.type()}: ${message.text()}`);
  });
  page.on("pageerror", (error) => page.complaints.push(error.message));
  if (hidden) await page.addInitScript(hidden);
  await page.goto(pathToFileURL(file).href + hash, { timeout: patience });
  await inTime(page.evaluate(async () => void (await window.evodevo)));
  return page;
}

/** Closes a page, which must not have complained. */
export async function closed(page) {
  assert.deepEqual(page.complaints, []);
  await page.close();
}

/** Opens a page on a phone, whose width it must fit. */
export async function onPhone(file) {
  const kind = { viewport: { width: 360, height: 740 }, hasTouch: true, isMobile: true, colorScheme: "dark" };
  const phone = await opened(file, kind);
  const width = await phone.evaluate(() => [document.documentElement.scrollWidth, innerWidth]);
  assert.ok(width[0] <= width[1], `${width[0]} wide`);
  return phone;
}

/** Clicks a button, and returns the name and the content of the file that it saves. */
export async function saved(page, button) {
  const [download] = await Promise.all([page.waitForEvent("download"), button.click()]);
  return { name: download.suggestedFilename(), content: readFileSync(await download.path()) };
}

/** Calls a function in the page with the page's parts {viewer, charts, data}, then waits until the page is drawn. */
export async function inPage(page, action, argument) {
  const answer = page.evaluate(
    async ([text, given]) => {
      const result = await new Function(`return (${text})`)()(await window.evodevo, given);
      await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
      return result;
    },
    [action.toString(), argument],
  );
  return inTime(answer);
}

/** Waits until a function of the page's parts, and of an argument, returns true. Throws if it has not after `patience`. */
export async function until(page, condition, argument) {
  const end = Date.now() + patience;
  while (!(await inPage(page, condition, argument)))
    if (Date.now() > end) throw new Error(`it is still not true that ${condition}, with ${JSON.stringify(argument)}`);
}

/** Returns the pixels of a PNG. They stay in the page, since counting them there is faster than transferring them. */
export const pixels = (page, png) =>
  page.evaluateHandle(async (base64) => {
    const image = new Image();
    image.src = `data:image/png;base64,${base64}`;
    await image.decode();
    const context = new OffscreenCanvas(image.width, image.height).getContext("2d");
    context.drawImage(image, 0, 0);
    return context.getImageData(0, 0, image.width, image.height);
  }, png.toString("base64"));

/** Takes a picture of the stage without captions. */
export async function picture(page) {
  await page.addStyleTag({ content: ".caption { visibility: hidden }" });
  return pixels(page, await (await page.$(".stage")).screenshot());
}

/** Returns the numbers of pixels that differ clearly between two pictures, in the left and in the right half. */
export async function differing(a, b) {
  return a.evaluate(({ data, width }, other) => {
    const counts = [0, 0];
    for (let i = 0; i < data.length; i += 4)
      if ([0, 1, 2].some((k) => Math.abs(data[i + k] - other.data[i + k]) > 24))
        ++counts[2 * ((i / 4) % width) < width ? 0 : 1];
    return counts;
  }, b);
}

export const sum = (numbers) => numbers.reduce((a, b) => a + b, 0);

/** Returns points by x, then by y. */
export const sorted = (points) => [...points].sort((a, b) => a[0] - b[0] || a[1] - b[1]);
