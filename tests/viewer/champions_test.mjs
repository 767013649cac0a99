// The best robot over the generations, as a strip of pictures.
import assert from "node:assert/strict";
import { before, test } from "node:test";
import { archived, closed, evodevo, inPage, opened, ran, reported, scratch, until } from "./support.mjs";

let page, expected;

before(async () => {
  page = await opened(reported(ran("run", ["experiment.verify=0", "experiment.evaluations=132"]), "--best", "1"));
  const born = archived(scratch.run,
    "SELECT id, born, value FROM individuals JOIN scores ON individual = id WHERE objective = 0 AND status = 'ok' ORDER BY born, value DESC, id");
  // the best of each generation, if no earlier one was as good
  expected = born.filter(([, generation, value], i) => born.slice(0, i).every((other) => other[1] < generation && other[2] < value));
});

const buttons = () => page.locator(".champions button");

test("the strip has the best robot of each generation in which it changed, with its fitness", async () => {
  assert.ok(expected.length > 2, `${expected.length} champions`);
  const shown = await buttons().evaluateAll((all) => all.map(({ textContent }) => textContent));
  const numbers = shown.map((text) => /^(\S+) body lengths generation (\d+) individual (\d+) /.exec(`${text} `).slice(1).map(Number));
  assert.deepEqual(numbers, expected.map(([id, generation, value]) => [Number(value.toPrecision(4)), generation, id]));
});

test("each robot has a picture of its body at birth", async () => {
  await inPage(page, ({ pictured }) => pictured);
  const pictures = await page.locator(".champions canvas").evaluateAll((all) =>
    all.map((canvas) => {
      const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
      return [data.filter((value, i) => i % 4 === 3 && value > 0).length, canvas.toDataURL()];
    }),
  );
  for (const [pixels] of pictures) assert.ok(pixels > 200, `${pixels} pixels`);
  assert.equal(new Set(pictures.map(([, url]) => url)).size, expected.length, "two are the same picture");
  const absent = await inPage(page, ({ data }) => data.runs[0].champions.shown.filter(({ film }) => film).map((one) => [one.individual, one.film.masses]));
  assert.ok(absent.length > 0);
  for (const [individual, masses] of absent)
    assert.equal(masses, JSON.parse(evodevo("body", scratch.run, "--individual", String(individual))).masses.length);
});

test("a robot on the page opens, with the keyboard too; of another it says how to see it", async () => {
  const on = await inPage(page, ({ viewer }) => viewer.robots.map(({ robot }) => robot.individual));
  const place = (isThere) => expected.findIndex(([id]) => on.includes(id) === isThere);
  await inPage(page, ({ viewer }, id) => viewer.show(viewer.robots.findIndex(({ robot }) => robot.individual !== id)), expected[place(true)][0]);
  await buttons().nth(place(true)).focus();
  await page.keyboard.press("Enter");
  await until(page, ({ viewer }, id) => viewer.stages[0].life.robot.individual === id, expected[place(true)][0]);
  await buttons().nth(place(false)).click();
  assert.match(await page.locator(".notice").textContent(), new RegExp(`--individual ${expected[place(false)][0]}$`));
  assert.match(await buttons().nth(place(false)).textContent(), /not on the page$/);
  assert.doesNotMatch(await buttons().nth(place(true)).textContent(), /not on the page/);
});

test("where the best changed often, the strip has 40 of its robots, and says of how many", async () => {
  const run = ran("often", ["experiment.verify=0", "experiment.evaluations=540", "development.cycles=0"]);
  archived(run, "UPDATE scores SET value = individual"); // now each generation has a new best robot
  const best = archived(run, "SELECT max(id) FROM individuals WHERE status = 'ok' GROUP BY born ORDER BY born").map(([id]) => id);
  assert.ok(best.length > 40, `${best.length}`);
  const tab = await opened(reported(run, "--best", "1"));
  const ids = (await tab.locator(".champions button").allTextContents()).map((text) => Number(/individual (\d+)/.exec(text)[1]));
  assert.equal(ids.length, 40);
  assert.deepEqual([ids[0], ids.at(-1)], [best[0], best.at(-1)]);
  assert.deepEqual(ids, best.filter((id) => ids.includes(id)));
  assert.match(await tab.locator(".champions .note").textContent(), new RegExp(`40 of ${best.length}\\b`));
  await closed(tab);
});
