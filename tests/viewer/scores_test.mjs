// The report's page of runs with several objectives, other scores and scenarios.
import assert from "node:assert/strict";
import { cpSync, readFileSync, writeFileSync } from "node:fs";
import { before, test } from "node:test";
import { archived, closed, inPage, onPhone, opened, ran, reported, scratch, sorted, until } from "./support.mjs";

const far = "<b>far</b>"; // would be bold if it were interpreted as markup
const run = scratch.path("scores");
let report, page;

const window = "settle = 0.5\nwindow = 1.0\n";
const objective = (name, keys) => `[[fitness]]\nname = "${name}"\n${keys}${window}`;
const experiment = `${readFileSync(scratch.file, "utf8").replace(`name = "distance"`, `name = "distance"\nlabel = "${far}"`)}
${objective("actuation-work", "")}
${objective("descriptor", `what = "height"\nlabel = "stature"\n`)}
${objective("descriptor", `what = "contact"\nlabel = "touching"\n`)}
[[scenario]]
name = "flat"
[[scenario]]
name = "hurt"
damage = 0.1
repeat = 2
`;

before(async () => {
  const file = scratch.path("scores.toml");
  writeFileSync(file, experiment);
  report = reported(ran("scores", [], file), "--individual", "0");
  page = await opened(report);
});

const figure = (title) => page.locator("figure", { has: page.locator("figcaption", { hasText: title }) });
const choose = (title, label, score) => figure(title).getByLabel(label).selectOption({ label: score });
const optionsOf = (select) => select.locator("option").allTextContents();

test("names, units and directions are as given, and nothing is complained of", async () => {
  const scores = [`${far} (body lengths)`, "actuation-work (J)", "stature (m)", "touching"];
  const heads = ["Robot", "Individual", ...scores, "Born", "Age", "Made by", "First parents"];
  assert.deepEqual(await page.locator(".robots th").allTextContents(), heads);
  const fact = page.locator(".fact", { hasText: "Best actuation-work" });
  const least = archived(run, "SELECT min(value) FROM scores WHERE objective = 1")[0][0];
  assert.equal(await fact.locator("b").textContent(), String(Number(least.toPrecision(4))));
  assert.equal(await fact.locator("span").textContent(), "J, lower is better");
  assert.equal(await page.locator("b", { hasText: /^far$/ }).count(), 0);
  assert.deepEqual(page.complaints, []);
});

test("the progress in each objective can be chosen", async () => {
  const select = figure("Fitness over evaluations").getByLabel("Objective");
  assert.deepEqual(await optionsOf(select), [`${far} (body lengths)`, "actuation-work (J)"]);
  await select.focus();
  await page.keyboard.press("ArrowDown");
  const members = archived(run,
    "SELECT generation, value FROM members JOIN scores USING (individual) WHERE objective = 1 ORDER BY generation, value");
  const evaluations = archived(run, "SELECT evaluations FROM generations ORDER BY generation");
  const worksOf = (generation) => members.filter(([g]) => g === generation).map(([, value]) => value);
  const median = (all) => (all[Math.floor((all.length - 1) / 2)] + all[Math.floor(all.length / 2)]) / 2;
  const works = evaluations.map((_, generation) => worksOf(generation));
  const data = await inPage(page, ({ charts }) => charts.byName.evaluations.data);
  assert.deepEqual(data, [evaluations.flat(), works.map(([least]) => least), works.map(median)]);
  const axis = await inPage(page, ({ charts }) => charts.byName.evaluations.plot.axes[1].label);
  assert.equal(axis, "actuation-work (J), lower is better");
  const other = await inPage(page, ({ charts }) => charts.byName.springs.data[1]);
  assert.deepEqual(other, archived(run, "SELECT best FROM generations ORDER BY generation").flat());
});

const near = (points, expected) => {
  assert.equal(points.length, expected.length);
  points.forEach(([x, y], i) => {
    assert.ok(Math.abs(x - expected[i][0]) <= 1e-6 * (1 + Math.abs(x)), `${x}, not ${expected[i][0]}`);
    assert.equal(y, expected[i][1]);
  });
};
const points = async (series) => {
  const data = await inPage(page, ({ charts }) => charts.byName.ages.data);
  return sorted(data[series].flatMap((y, i) => (y === null ? [] : [[data[0][i], y]])));
};

test("the axes of the living can be chosen among age, objectives and other scores", async () => {
  const title = "The living";
  const groups = figure(title).getByLabel("x axis").locator("optgroup");
  assert.deepEqual(await groups.evaluateAll((all) => all.map(({ label }) => label)), ["Age", "Objectives", "Descriptors"]);
  await choose(title, "x axis", `${far} (body lengths)`);
  await choose(title, "y axis", "actuation-work (J)");
  const living = archived(run,
    "SELECT a.value, b.value FROM individuals JOIN scores a ON a.individual = id JOIN scores b ON b.individual = id WHERE died IS NULL AND a.objective = 0 AND b.objective = 1");
  near(await points(1), sorted(living));
  const unbeaten = living.filter(
    ([x, y]) => !living.some(([a, b]) => a >= x && b <= y && (a > x || b < y)), // far with little work
  );
  near(await points(2), sorted(unbeaten));
  assert.match(await figure(title).locator("figcaption").textContent(), /front/);

  await choose(title, "y axis", "touching");
  const touching = archived(run,
    "SELECT s.value, m.value FROM individuals JOIN scores s ON s.individual = id JOIN measured m ON m.individual = id WHERE died IS NULL AND s.objective = 0 AND m.measure = 1");
  near(await points(1), sorted(touching));
  assert.equal(await inPage(page, ({ charts }) => charts.byName.ages.data.length), 2, "no front");
  assert.doesNotMatch(await figure(title).locator("figcaption").textContent(), /front/);
});

/** Changes the theme, and waits until the page, which hears of it later, has heard of it. */
async function useColours(colorScheme) {
  await page.evaluate(() => {
    const theme = matchMedia("(prefers-color-scheme: dark)");
    window.heard = new Promise((done) => theme.addEventListener("change", done, { once: true }));
  });
  await page.emulateMedia({ colorScheme });
  await page.evaluate(() => window.heard);
}

test("what is chosen stays when the theme changes", async () => {
  const choice = figure("The living").getByLabel("y axis");
  const chosen = await choice.inputValue();
  const before = await points(1);
  await useColours("dark");
  const dark = await inPage(page, ({ charts }) => charts.byName.ages.plot.series[1].points.fill());
  await useColours("light");
  assert.notEqual(dark, await inPage(page, ({ charts }) => charts.byName.ages.plot.series[1].points.fill()));
  assert.equal(await choice.inputValue(), chosen);
  assert.deepEqual(await points(1), before);
});

/** The rows of the table of tests: for each, its name and scores. */
const rowsOfTests = () => page.locator(".tests tbody tr").evaluateAll((rows) =>
  rows.map((row) => [...row.children].map((cell) => cell.firstChild.textContent)));
const short = (value) => (Math.abs(value) < 1e-3 ? undefined : String(Number(value.toPrecision(4))));

test("the scores by test are those of the robots shown", async () => {
  const expected = (id) => {
    const tests = archived(run, `SELECT value FROM tests WHERE individual = ${id} ORDER BY scenario, repeat, objective`);
    const all = archived(run, `SELECT value FROM scores WHERE individual = ${id} ORDER BY objective`);
    return [...tests, ...all].flat().map(short);
  };
  const agree = (cells, numbers) => {
    assert.equal(cells.length, numbers.length);
    assert.ok(numbers.filter((number) => number !== undefined).length > 3);
    numbers.forEach((number, i) => number === undefined || assert.equal(cells[i], number));
  };
  const ids = await inPage(page, ({ viewer }) => viewer.robots.map(({ robot }) => robot.individual));
  const one = await rowsOfTests();
  assert.deepEqual(one.map(([name]) => name), ["flat", "hurt, repeat 1", "hurt, repeat 2", "combined"]);
  agree(one.flatMap(([, ...scores]) => scores), expected(ids[0]));
  assert.equal(await page.locator(".tests tr", { hasText: "in the film" }).locator("th").first().textContent(), "flatin the film");
  await page.getByLabel("beside").selectOption("1");
  await until(page, ({ viewer }) => viewer.stages.length === 2);
  agree((await rowsOfTests()).flatMap(([, , , ...scores]) => scores), expected(ids[1]));
  await page.getByLabel("beside").selectOption("");
  await until(page, ({ viewer }) => viewer.stages.length === 1);
});

test("beside the film stand its test and how far the robot has moved in it", async () => {
  await inPage(page, ({ viewer }) => viewer.seek(viewer.end));
  const caption = page.locator(".caption").first();
  assert.match(await caption.locator("span").textContent(), /^measured in flat · .* · (-?[\d.]+) of \1 body lengths \(-?[\d.]+ m\) along \+x$/);
  assert.match(await caption.locator("strong").textContent(), /far<\/b> \S+ body lengths, actuation-work \S+ J$/);
  const hurt = await opened(reported(run, "--best", "1", "--scenario", "hurt"));
  assert.equal(await hurt.locator(".tests tr", { hasText: "in the film" }).locator("th").textContent(), "hurt, repeat 1in the film");
  const filmed = await inPage(hurt, ({ viewer }) => viewer.robots[0].robot);
  const scores = `SELECT value FROM tests WHERE individual = ${filmed.individual} AND scenario = 1 AND repeat = 0`;
  assert.deepEqual(filmed.again, archived(run, `${scores} ORDER BY objective`).flat(), "the same bits");
  await hurt.close();
});

test("a score that differs in the life shown is told beside the test", async () => {
  const changed = scratch.path("changed");
  cpSync(run, changed, { recursive: true });
  archived(changed, "UPDATE tests SET value = 77 WHERE scenario = 0 AND objective = 1");
  const other = await opened(reported(changed, "--best", "1"));
  const texts = await other.locator(".tests tbody tr").first().locator("td").allTextContents();
  assert.match(texts[1], /^77 \(as shown: [\d.]+\)$/);
  assert.doesNotMatch(texts[0], /as shown/);
  await other.close();
});

test("the best robot by each objective is shown", async () => {
  const least = archived(run, "SELECT individual FROM scores WHERE objective = 1 ORDER BY value, individual LIMIT 1")[0][0];
  const robots = await inPage(page, ({ viewer }) => viewer.robots.map(({ robot }) => [robot.role, robot.individual]));
  assert.equal(robots[0][0], `best in ${far}`);
  assert.ok(robots.some(([role, id]) => id === least && role.startsWith("best")), JSON.stringify(robots));
});

test("runs with different objectives can be compared in each that one of them has", async () => {
  const other = ran("other");
  const both = await opened(reported(run, other, "--best", "1"));
  const select = both.locator("figure", { hasText: "Fitness over evaluations" }).getByLabel("Objective");
  assert.deepEqual(await optionsOf(select), [`${far} (body lengths)`, "actuation-work (J)", "distance (body lengths)"]);
  await select.selectOption({ label: "distance (body lengths)" });
  const data = await inPage(both, ({ charts }) => charts.byName.evaluations.data);
  assert.ok(data[1].every((value) => value === null));
  assert.deepEqual(data[3], archived(other, "SELECT best FROM generations ORDER BY generation").flat());
  await closed(both);
});

test("it fits a phone", async () => closed(await onPhone(report)));
