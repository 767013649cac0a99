// Takes a picture of elites from all over a map of niches for the README: node zoo.mjs REPORT.html FOLDER
import { launch, opened } from "./browser.mjs";
import { shrinkStage, tile, writeSheet } from "./sheet.mjs";

const [columns, rows] = [5, 3]; // parts of the map; the picture shows the best robot of each
const size = { width: 220, height: 220 };
const across = 6; // tiles in each row of the picture
const distance = 4.2; // of the camera from each robot, m

const [report, folder] = process.argv.slice(2);
const browser = await launch();
const page = await opened(browser, report, { viewport: { width: 1080, height: 900 } });
await shrinkStage(page, size);
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

/** Shows a robot; returns the middle of its measurement, s. */
const show = ({ index }) =>
  page.evaluate(
    async ([robot, metres]) => {
      const { viewer } = await window.evodevo;
      await viewer.show(robot);
      viewer.camera.position.normalize().multiplyScalar(metres);
      const { begin, end } = viewer.stages[0].life.shots.at(-1);
      return (begin + end) / 2;
    },
    [index, distance],
  );

const rounded = (number) => String(Number(number.toPrecision(2)));
const quantity = ({ name, unit }, { measures }) =>
  `${name} ${rounded(measures[name])}${unit === "1" ? "" : `\u00a0${unit}`}`;
const tiles = [];
for (let row = rows - 1; row >= 0; --row)
  for (let column = 0; column < columns; ++column) {
    const elite = bestIn(column, row);
    if (!elite) continue;
    const text = map.axes.map((axis) => quantity(axis, elite)).join(", ");
    tiles.push(await tile(page, await show(elite), `<b>${rounded(elite.value)}</b> ${text}`));
  }
await writeSheet(browser, tiles, across, size.width, folder, "zoo.png");
await browser.close();
