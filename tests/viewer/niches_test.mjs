// The report's page of runs with a map of niches, and with what selection notes about individuals.
import assert from "node:assert/strict";
import { readFileSync, writeFileSync } from "node:fs";
import { before, test } from "node:test";
import { closed, inPage, onPhone, opened, ran, reported, scratch, until, writeChanged } from "./support.mjs";

const bold = "<b>reach</b>"; // would be bold if it were interpreted as markup
const proto = "__proto__"; // would be lost, or do harm, if it were a key of an ordinary object
const filmed = 9000; // the first of the elites that have a robot on the page
const unfilmed = 777;
let page, report;

/** Writes a page with the data of another one, as changed by a function, and opens it. */
async function changed(name, change, open = opened) {
  const file = scratch.path(`${name}.html`);
  writeChanged(report, file, (data) => ({ ...data, runs: change(data.runs[0]) }));
  return open(file);
}

/** Elites by column, row (from the bottom), individual and value. The robots of `filmed` and of the next individual are
 *  on the page, as is the best, `first`. */
const elitesOf = (first) => [
  { cell: [0, 0], individual: filmed, value: -1 },
  { cell: [3, 0], individual: unfilmed, value: 0.5 },
  { cell: [1, 2], individual: first, value: 1 },
  { cell: [3, 2], individual: filmed + 1, value: 0.5 },
];
const axes = [
  { name: bold, unit: "m", low: -1, high: 1, bins: 4 },
  { name: proto, unit: "1", low: 0, high: 0.3, bins: 3 },
];

/** Returns a run with a map, elites, notes and labels. */
function mapped(run) {
  const robot = (i) => ({ ...run.robots[1], individual: filmed + i, role: "elite", notes: { [proto]: 0.25 + i } });
  const growing = run.generations.map((_, i) => i + 1);
  return {
    ...run,
    map: { objective: run.objectives[0].name, axes, cells: 12, elites: elitesOf(run.robots[0].individual) },
    notes: [proto, bold].map((name) => ({ name, unit: "1", is_label: name === bold })),
    labels: [
      {
        name: bold,
        groups: [{ label: 1234567, counts: growing }, { label: 2, counts: growing.map((n) => 2 * n) }],
        others: growing.map(() => 3),
      },
    ],
    robots: [...run.robots.map((one) => ({ ...one, notes: { [bold]: 1234567 } })), robot(0), robot(1)],
    generations: run.generations.map((g, i) => ({
      ...g,
      map: { filled: i + 1, coverage: (i + 1) / 12, qd_score: i / 2 },
      notes: { [proto]: { greatest: 10 + i, median: i }, [bold]: { groups: 2 } },
    })),
  };
}

before(async () => {
  report = reported(ran("run", ["experiment.verify=0"]));
  page = await changed("mapped", (run) => [mapped(run)]);
});

const figure = (title) => page.locator("figure", { has: page.locator("figcaption", { hasText: title }) });
const niche = (individual, of = page) => of.getByRole("button", { name: new RegExp(`individual ${individual},`) });
const info = () => page.locator(".niches .note").textContent();
const outlined = async (of = page) => (await of.locator(".niche[aria-current]").all()).length;
const isOutlined = async (individual) => (await niche(individual).getAttribute("aria-current")) === "true";
const showing = (index, of = page) =>
  until(of, ({ viewer: { stages, robots } }, i) => stages.length === 1 && stages[0].life.robot === robots[i].robot, index);
const indexOf = (individual) =>
  inPage(page, ({ viewer }, id) => viewer.robots.findIndex(({ robot }) => robot.individual === id), individual);
const pick = async (individual) => {
  const index = await indexOf(individual);
  await page.locator(".pickers select").first().selectOption(String(index));
  await showing(index);
};
const best = () => inPage(page, ({ viewer }) => viewer.robots[0].robot.individual);

test("each elite lies in its cell, x to the right and y upwards", async () => {
  const { x, y, width, height } = await page.locator(".cells").boundingBox();
  for (const { cell, individual } of elitesOf(await best())) {
    const box = await niche(individual).boundingBox();
    const middle = [(box.x + box.width / 2 - x) / width, 1 - (box.y + box.height / 2 - y) / height];
    assert.deepEqual([Math.floor(4 * middle[0]), Math.floor(3 * middle[1])], cell, `individual ${individual}`);
    assert.ok(Math.abs(box.width - width / 4) < 2 && Math.abs(box.height - height / 3) < 2);
  }
  assert.deepEqual(page.complaints, []);
});

test("axes have names, units and values at borders of cells; a name is never markup", async () => {
  assert.equal(await page.locator(".x.title").textContent(), `${bold} (m)`);
  assert.equal(await page.locator(".y.title").textContent(), proto);
  assert.deepEqual(await page.locator(".x.values span").allTextContents(), ["-1", "-0.5", "0", "0.5", "1"]);
  assert.deepEqual(await page.locator(".y.values span").allTextContents(), ["0", "0.1", "0.2", "0.3"]);
  const zero = await page.locator(".x.values span", { hasText: /^0$/ }).boundingBox();
  const { x, width } = await page.locator(".cells").boundingBox();
  assert.ok(Math.abs(zero.x + zero.width / 2 - x - width / 2) < 2);
  assert.equal(await page.locator("b", { hasText: /^reach$/ }).count(), 0);
});

test("the colours go from the lowest to the highest value, which the legend states", async () => {
  assert.deepEqual(await page.locator(".niches .bar-of-colours span").allTextContents(), ["-1", "1 body lengths"]);
  const colour = (individual) => niche(individual).locator("i").evaluate((i) => getComputedStyle(i).backgroundColor);
  const bar = await page.locator(".niches .bar-of-colours .scale").evaluate((i) => getComputedStyle(i).backgroundImage);
  const stops = bar.match(/rgb\([^)]*\)/g);
  assert.equal(await colour(filmed), stops[0]);
  assert.equal(await colour(await best()), stops.at(-1));
  assert.equal(await colour(unfilmed), await colour(filmed + 1));
  assert.ok(new Set(stops).size === stops.length && !stops.slice(1, -1).includes(await colour(filmed)));
});

test("the page says how many cells are filled", async () => {
  const fact = page.locator(".fact", { hasText: "Coverage" });
  assert.equal(await fact.locator("b").textContent(), "4 of 12");
  const last = await inPage(page, ({ data }) => data.runs[0].generations.length - 1);
  assert.ok((await fact.locator("span").textContent()).includes(String(last / 2)));
});

test("a cell tells its ranges, its individual and its value, or that it is empty", async () => {
  await niche(filmed + 1).hover();
  assert.equal(await info(), `${bold} from 0.5 m up, ${proto} from 0.2 up: individual ${filmed + 1}, 0.5 body lengths`);
  const { x, y, width, height } = await page.locator(".cells").boundingBox();
  await page.mouse.move(x + (1.5 / 4) * width, y + (1.5 / 3) * height);
  assert.equal(await info(), `${bold} -0.5 to 0 m, ${proto} 0.1 to 0.2: empty`);
  await page.mouse.move(x + (0.1 / 4) * width, y + (2.9 / 3) * height);
  assert.match(await info(), new RegExp(`below -0.5 m, ${proto} below 0.1: individual ${filmed}, -1 body`));
  await page.mouse.move(x, y - 100);
  assert.match(await info(), /^4 of 12 cells/);
});

test("a click opens the robot of a cell, and goes to it", async () => {
  await niche(filmed).click();
  await showing(await indexOf(filmed));
  assert.deepEqual([await outlined(), await isOutlined(filmed)], [1, true]);
  await until(page, ({ viewer }) => Math.abs(viewer.root.getBoundingClientRect().top) < 2);
});

test("robots chosen elsewhere are outlined in the map", async () => {
  await pick(filmed + 1);
  assert.deepEqual([await outlined(), await isOutlined(filmed + 1)], [1, true]);
  await page.getByLabel("beside").selectOption(String(await indexOf(filmed)));
  await until(page, ({ viewer }) => viewer.stages.length === 2);
  assert.deepEqual([await outlined(), await isOutlined(filmed + 1), await isOutlined(filmed)], [2, true, true]);
  await page.getByLabel("beside").selectOption("");
  await until(page, ({ viewer }) => viewer.stages.length === 1);
  await page.locator(".robots button").nth(1).click(); // of a robot without a cell
  await showing(1);
  assert.equal(await outlined(), 0);
});

test("the keyboard reaches every cell, and opens its robot", async () => {
  await pick(await best());
  await inPage(page, ({ viewer }) => viewer.seek(1));
  assert.equal(await page.locator('.niche[tabindex="0"]').count(), 1);
  await page.locator('.niche[tabindex="0"]').focus();
  const focused = async () => {
    return Number(/individual (\d+)/.exec(await page.evaluate(() => document.activeElement.ariaLabel))[1]);
  };
  const first = await best();
  assert.equal(await focused(), first);
  for (const [key, ...reached] of [
    ["Left", first], // there is none before it
    ["Right", filmed + 1, filmed, unfilmed, unfilmed],
    ["Up", filmed + 1, filmed + 1],
    ["Left", first],
    ["Down", filmed, filmed],
    ["Up", first],
  ]) for (const individual of reached) {
    await page.keyboard.press(`Arrow${key}`);
    assert.equal(await focused(), individual, key);
    assert.equal(await page.locator('.niche[tabindex="0"]').count(), 1);
    assert.match(await info(), new RegExp(`individual ${individual},`));
  }
  assert.equal(await inPage(page, ({ viewer }) => viewer.time), 1, "the film has been steered as well");
  await page.keyboard.press("ArrowDown");
  await page.keyboard.press("Enter");
  await showing(await indexOf(filmed));
  assert.ok(await isOutlined(filmed));
});

const chart = (name, of = page) =>
  inPage(of, ({ charts }, key) => {
    const { data, plot } = charts.byName[key];
    return { data, labels: plot.series.map(({ label }) => label), y: plot.axes[1].label };
  }, name);
const generations = () => inPage(page, ({ data }) => data.runs[0].generations);

test("coverage and QD score can be chosen", async () => {
  const all = await generations();
  const evaluations = all.map((g) => g.evaluations);
  assert.deepEqual((await chart("niches")).data, [evaluations, all.map((g) => 100 * g.map.coverage)]);
  const title = "Coverage and QD score over evaluations";
  await figure(title).getByLabel("y axis").selectOption({ label: "QD score (body lengths)" });
  const scored = await chart("niches");
  assert.deepEqual(scored.data, [evaluations, all.map((g) => g.map.qd_score)]);
  assert.equal(scored.y, "QD score (body lengths)");
});

test("what is noted is shown over generations, and beside the robots", async () => {
  const numbers = (await generations()).map((g) => g.generation);
  const quantity = await chart(`note ${proto}`);
  assert.deepEqual(quantity.data, [numbers, numbers.map((_, i) => 10 + i), numbers.map((_, i) => i)]);
  assert.deepEqual(quantity.labels.slice(1), ["greatest", "median"]);
  const groups = await chart(`groups ${bold}`);
  const tops = [3, 1].map((n) => numbers.map((_, i) => n * (i + 1)));
  assert.deepEqual(groups.data, [numbers, tops[0].map((n) => n + 3), tops[0], tops[1]]);
  assert.deepEqual(groups.labels.slice(1), ["others", `${bold} 2`, `${bold} 1234567`]);
  assert.equal(await figure(`${bold} over generations`).count(), 1);
  const heads = await page.locator(".robots th").allTextContents();
  const cells = (row) => page.locator(".robots tbody tr").nth(row).locator("td").allTextContents();
  const columns = [heads.indexOf(proto), heads.indexOf(bold)];
  const of = (texts) => columns.map((column) => texts[column]);
  assert.deepEqual(of(await cells(0)), ["–", "1234567"]);
  assert.deepEqual(of(await cells(await indexOf(filmed + 1))), ["1.25", "–"]);
});

test("several runs have a map each, with the same colours, and their elites come last", async () => {
  const both = await changed("both", (run) => {
    const other = { ...mapped(run), folder: "/runs/it's other" };
    const higher = elitesOf(run.robots[0].individual).map((elite) => ({ ...elite, value: elite.value + 1 }));
    return [mapped(run), { ...other, map: { ...other.map, elites: higher } }];
  });
  const maps = both.locator(".niches");
  assert.equal(await maps.count(), 2);
  for (const map of await maps.all())
    assert.deepEqual(await map.locator(".bar-of-colours span").allTextContents(), ["-1", "2 body lengths"]);
  const colour = (which, individual) =>
    niche(individual, maps.nth(which)).locator("i").evaluate((i) => i.style.background);
  const first = await inPage(both, ({ viewer }) => viewer.robots[0].robot.individual);
  assert.notEqual(await colour(0, unfilmed), await colour(1, unfilmed));
  assert.notEqual(await colour(0, first), await colour(1, first));
  const roles = await inPage(both, ({ viewer }) => viewer.robots.map(({ robot }) => robot.role));
  assert.equal(roles.indexOf("elite"), roles.length - 4);
  await niche(unfilmed, maps.nth(1)).click();
  const command = await maps.nth(1).locator("code").textContent();
  assert.equal(command, `evodevo report '/runs/it'\\''s other' --individual ${unfilmed}`);
  assert.equal(await inPage(both, ({ viewer }) => viewer.chosen[0]), 0);
  await niche(filmed, maps.nth(1)).click();
  await showing(roles.length - 2, both);
  assert.deepEqual([await outlined(maps.nth(0)), await outlined(maps.nth(1))], [0, 1]);
  assert.equal((await chart("niches", both)).labels.length, 3);
  await closed(both);
});

test("a single descriptor gives a single row, and a QD score is shown only where there is one", async () => {
  const single = await changed("single", (run) => {
    const made = mapped(run);
    const elites = [0, 3].map((column) => ({ cell: [column], individual: filmed + column, value: 0.5 }));
    const generations = made.generations.map((g) => ({ ...g, map: { ...g.map, qd_score: null } }));
    return [{ ...made, generations, map: { ...made.map, axes: axes.slice(0, 1), cells: 4, elites } }];
  });
  const boxes = await Promise.all([filmed, filmed + 3].map((id) => niche(id, single).boundingBox()));
  assert.ok(boxes[0].y === boxes[1].y && boxes[1].x > boxes[0].x + 2.5 * boxes[0].width);
  assert.equal(await single.locator(".y.values").count(), 0);
  assert.equal(await single.locator("figure", { hasText: "Coverage over evaluations" }).locator("select").count(), 0);
  assert.equal(await single.locator(".fact", { hasText: "Coverage" }).locator("span").textContent(), "cells");
  await closed(single);
});

test("without a map, notes and labels, there is nothing of them", async () => {
  const plain = await changed("plain", (run) => [{ ...run, map: null, notes: [], labels: [] }]);
  assert.equal(await plain.locator(".niches").count(), 0);
  assert.equal(await plain.locator(".fact", { hasText: "Coverage" }).count(), 0);
  const charts = await inPage(plain, ({ charts }) => Object.keys(charts.byName));
  assert.deepEqual(charts, ["evaluations", "springs", "ages", "statuses"]);
  await closed(plain);
});

test("a map without any elite, and one without robots on the page, do no harm", async () => {
  const bare = await changed("bare", (run) => [
    { ...mapped(run), robots: [] },
    { ...mapped(run), robots: [], map: { ...mapped(run).map, elites: [] } },
  ]);
  assert.equal(await bare.locator(".niches").count(), 1);
  await niche(filmed, bare).click();
  assert.match(await bare.locator(".niches code").textContent(), new RegExp(`--individual ${filmed}$`));
  await closed(bare);
});

test("the map fits a phone", async () => {
  const phone = await changed("phone", (run) => [mapped(run)], onPhone);
  const box = await niche(filmed, phone).boundingBox();
  assert.ok(box.width > 24 && box.height > 24);
  await closed(phone);
});

test("every cell of a real run opens its robot", async () => {
  const descriptor = (what) => `[[fitness]]\nname = "descriptor"\nwhat = "${what}"\nsettle = 0.5\nwindow = 1.0\nbins = 3\n`;
  const file = scratch.path("map.toml");
  const text = readFileSync(scratch.file, "utf8").replace("age-fitness-pareto", "map-elites");
  writeFileSync(file, text + descriptor("height") + descriptor("contact"));
  const real = await opened(reported(ran("map", ["experiment.verify=0"], file), "--best", "0"));
  const elites = await inPage(real, ({ data }) => data.runs[0].map.elites);
  assert.ok(elites.length > 1);
  for (const { individual } of elites) {
    await niche(individual, real).click();
    await until(real, ({ viewer: { stages } }, id) => stages[0].life.robot.individual === id, individual);
  }
  const cell = await inPage(real, ({ viewer }) => viewer.stages[0].life.robot.notes.cell);
  assert.equal(cell, 3 * elites.at(-1).cell[0] + elites.at(-1).cell[1]);
  await closed(real);
});
