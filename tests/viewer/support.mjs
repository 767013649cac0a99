// Code that the tests of the page share: a small run, a browser, and functions that examine pictures.
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { pathToFileURL } from "node:url";

export const { chromiumProgram, inTime, launch, patience } = await import(pathToFileURL(join(process.env.EVODEVO_VIEWER, "browser.mjs")).href);

/** Names that would be harmful if they were interpreted as markup. */
export const experimentName = `<img src=x onerror="window.harmed=1">`;
export const materialName = `</script><script>window.harmed=1</script>`;

const experiment = (cycles) => `
[experiment]
seed = 3
evaluations = 48
population = 12
[encoding]
name = "neural"
points = 40
neighbours = 8
[[mutation]]
name = "reset-weight"
[materials.${JSON.stringify(materialName)}]
stiffness = 3000
[scene.gravity]
[scene.floor]
[scene.friction]
[scene.damping]
[simulation]
device = "cpu"
[development]
cycles = ${cycles}
cycle_time = 0.5
[[development.operator]]
name = "spring-turnover"
springs = 6
[[development.operator]]
name = "mass-turnover"
springs = 9
[[fitness]]
name = "distance"
settle = 0.5
window = 1.0
[selection]
name = "age-fitness-pareto"
`;

export const cycles = 3;
export const cycleTime = 0.5;

export class Scratch {
  constructor() {
    this.folder = mkdtempSync(join(tmpdir(), "evodevo-viewer-"));
    this.file = join(this.folder, `${experimentName}.toml`);
    this.run = join(this.folder, "run");
    writeFileSync(this.file, experiment(cycles));
  }

  path(name) {
    return join(this.folder, name);
  }

  remove() {
    rmSync(this.folder, { recursive: true });
  }
}

export function evodevo(...words) {
  return execFileSync(process.env.EVODEVO_PROGRAM, words, { encoding: "utf8", maxBuffer: 1 << 28 });
}

/** Makes a run of robots that never live, since they have no springs. Returns its folder, its experiment, and the options
 * that make the springs of the experiment's other materials vanish. */
export function barrenRun(scratch) {
  const run = scratch.path("barren");
  const file = scratch.path("barren.toml");
  writeFileSync(file, readFileSync(scratch.file, "utf8").replace("stiffness = 3000", "stiffness = 0"));
  const soft = ["muscle", "muscle2", "tissue", "bone"].flatMap((name) => ["--set", `materials.${name}.stiffness=0`]);
  evodevo("run", file, "--out", run, ...soft);
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

/** Opens a page from its file. It does not play by itself, unless `options` say that motion is welcome; keeps the page's requests in `requests`, and its errors and warnings in `complaints`. */
export async function opened(browser, file, options = {}, { hash = "", before: hidden } = {}) {
  const page = await browser.newPage({ viewport: { width: 640, height: 600 }, reducedMotion: "reduce", ...options });
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

/** Takes a picture of the stage without captions. The picture stays in the page, since counting pixels there is faster
*  than transferring them. */
export async function picture(page) {
  await page.addStyleTag({ content: ".caption { visibility: hidden }" });
  const png = (await (await page.$(".stage")).screenshot()).toString("base64");
  return page.evaluateHandle(async (base64) => {
    const image = new Image();
    image.src = `data:image/png;base64,${base64}`;
    await image.decode();
    const context = new OffscreenCanvas(image.width, image.height).getContext("2d");
    context.drawImage(image, 0, 0);
    return context.getImageData(0, 0, image.width, image.height);
  }, png);
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

/** Returns the number of pixels with the amber colour of new springs. */
export async function amber(picture) {
  return picture.evaluate(({ data }) => {
    let count = 0;
    for (let i = 0; i < data.length; i += 4)
      if (data[i] > 150 && data[i] > 1.2 * data[i + 1] && data[i + 1] > 2.5 * data[i + 2]) ++count;
    return count;
  });
}

export const sum = (numbers) => numbers.reduce((a, b) => a + b, 0);
