// Takes a picture of the life of a robot that grows, for the README: node growth.mjs REPORT.html FOLDER
import { launch, opened } from "./browser.mjs";
import { shrinkStage, tile, writeSheet } from "./sheet.mjs";

const moments = 6; // tiles of the picture
const size = { width: 220, height: 240 };
const distance = 2.8; // of the camera from the robot, m

const [report, folder] = process.argv.slice(2);
const browser = await launch();
const page = await opened(browser, report, { viewport: { width: 1080, height: 900 } });
await shrinkStage(page, size);
const shots = await page.evaluate(async (metres) => {
  const { viewer } = await window.evodevo;
  await viewer.show(0);
  viewer.camera.position.normalize().multiplyScalar(metres);
  return viewer.stages[0].life.shots.map(({ name, begin, end, masses }) => ({ name, begin, end, masses: masses.length }));
}, distance);

const tiles = [];
for (let i = 0; i < moments; ++i) {
  const last = i === moments - 1;
  const shot = shots[Math.round((i * (shots.length - 1)) / (moments - 1))];
  const text = `<b>${shot.masses}</b> masses, ${i === 0 ? "at birth" : last ? "matured" : shot.name}`;
  tiles.push(await tile(page, i === 0 ? shot.begin : last ? shot.end : (shot.begin + shot.end) / 2, text));
}
await writeSheet(browser, tiles, moments, size.width, folder, "growth.png");
await browser.close();
