// Takes a picture of elites from all over a map of niches for the README: node zoo.mjs REPORT.html FOLDER
import { join } from "node:path";
import { draw, launch, opened } from "./browser.mjs";

const [columns, rows] = [5, 3]; // parts of the map; the picture shows the best robot of each
const tile = { width: 220, height: 220 };
const across = 6; // tiles in each row of the picture
const distance = 4.2; // of the camera from each robot, m

const [report, folder] = process.argv.slice(2);
const browser = await launch();
const page = await opened(browser, report, { viewport: { width: 1080, height: 900 } });
await page.addStyleTag({
  content: `.stage { width: ${tile.width}px !important; height: ${tile.height}px !important; min-height: 0 !important;
      aspect-ratio: auto !important }
    .caption { display: none }`,
});
const map = await page.evaluate(async () => {
  const { viewer } = await window.evodevo;
  const { map } = viewer.robots[0].run;
  const filmed = (elite) => {
    const index = viewer.robots.findIndex(({ robot }) => robot.individual === elite.individual);
    return { ...elite, index, measures: viewer.robots[index]?.robot.measures };
  };
  return { ...map, elites: map.elites.map(filmed) };
});

/** Returns the best elite in a part of the map, if there is one with a film. */
function bestIn(column, row) {
  const part = (bin, axis, parts) => Math.floor((bin * parts) / map.axes[axis].bins);
  const there = map.elites.filter(
    ({ cell: [x, y], index }) => index >= 0 && part(x, 0, columns) === column && part(y, 1, rows) === row,
  );
  return there.sort((a, b) => b.value - a.value)[0];
}

/** Returns a picture of a robot in the middle of its measurement. */
async function pictureOf({ index }) {
  const time = await page.evaluate(
    async ([robot, metres]) => {
      const { viewer } = await window.evodevo;
      await viewer.show(robot);
      viewer.camera.position.normalize().multiplyScalar(metres);
      const { begin, end } = viewer.stages[0].life.shots.at(-1);
      return (begin + end) / 2;
    },
    [index, distance],
  );
  await draw(page, time);
  return (await (await page.$("canvas")).screenshot()).toString("base64");
}

const rounded = (number) => String(Number(number.toPrecision(2)));
const quantity = ({ name, unit }, { measures }) =>
  `${name} ${rounded(measures[name])}${unit === "1" ? "" : `\u00a0${unit}`}`;
const figures = [];
for (let row = rows - 1; row >= 0; --row)
  for (let column = 0; column < columns; ++column) {
    const elite = bestIn(column, row);
    if (!elite) continue;
    const text = map.axes.map((axis) => quantity(axis, elite)).join(", ");
    figures.push(`<figure><img src="data:image/png;base64,${await pictureOf(elite)}">
      <figcaption><b>${rounded(elite.value)}</b> ${text}</figcaption></figure>`);
  }
const sheet = await browser.newPage({ viewport: { width: across * tile.width, height: 100 } });
await sheet.setContent(`<style>
  body { margin: 0; background: white; font: 13px system-ui, sans-serif; color: #444;
    display: grid; grid-template-columns: repeat(${across}, 1fr) }
  figure { margin: 0; padding: 4px } img { width: 100%; display: block; border-radius: 6px }
  figcaption { padding: 3px 2px } b { color: #b8404f }
</style>${figures.join("")}`);
await sheet.screenshot({ path: join(folder, "zoo.png"), fullPage: true });
await browser.close();
