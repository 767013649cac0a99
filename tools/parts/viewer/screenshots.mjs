// Takes the pictures of a report for the README: node screenshots.mjs REPORT.html FOLDER
import { join } from "node:path";
import { draw, launch, opened } from "./browser.mjs";

const [page, folder] = process.argv.slice(2);
const browser = await launch();
const light = await opened(browser, page, { viewport: { width: 1080, height: 1230 } });
await draw(light, await light.evaluate(async () => (await window.evodevo).viewer.stages[0].life.shots.at(-1).begin));
await light.screenshot({ path: join(folder, "report.png") });

const dark = await opened(browser, page, { viewport: { width: 1080, height: 900 }, colorScheme: "dark" });
await dark.evaluate(async () => {
  const { viewer } = await window.evodevo;
  await viewer.show(0, 1);
  viewer.setMode("cycle");
});
await draw(dark, await dark.evaluate(async () => (await window.evodevo).viewer.stages[0].life.shots[2].begin + 0.05));
await (await dark.$(".viewer")).screenshot({ path: join(folder, "viewer.png") });
await browser.close();
