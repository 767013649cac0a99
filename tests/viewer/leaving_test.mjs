// What leaves the report's page: files, links, and points in charts that open robots.
import assert from "node:assert/strict";
import { before, test } from "node:test";
import { archived, closed, evodevo, inPage, opened, pixels, ran, reported, saved, scratch, until } from "./support.mjs";

let report, page;

before(async () => {
  report = reported(ran("run", ["experiment.verify=0"]));
  page = await opened(report, { acceptDownloads: true });
});

const figure = (title) => page.locator("figure", { has: page.locator("figcaption", { hasText: title }) });

test("a chart leaves as CSV with the archive's numbers", async () => {
  const { name, content } = await saved(page, figure("Fitness over evaluations").getByRole("button", { name: "CSV" }));
  assert.equal(name, "Fitness-over-evaluations.csv");
  const [head, ...rows] = content.toString().trim().split("\n");
  assert.equal(head, "evaluations,best,median");
  const expected = archived(scratch.run, "SELECT evaluations, best, median FROM generations ORDER BY generation");
  assert.deepEqual(rows.map((row) => row.split(",").map(Number)), expected);
});

test("a chart leaves as SVG that shows what the chart shows", async () => {
  const living = archived(scratch.run, "SELECT count(*) FROM individuals WHERE died IS NULL AND status = 'ok'")[0][0];
  for (const [title, shapes, expected] of [
    ["Fitness over evaluations", "path[fill=none]"],
    ["Age and fitness of the living", "circle", living],
    ["How evaluations ended", "path[d$=Z]"],
  ]) {
    const { content } = await saved(page, figure(title).getByRole("button", { name: "SVG" }));
    const [error, count, strange] = await page.evaluate(
      ([text, selector]) => {
        const { documentElement: root } = new DOMParser().parseFromString(text, "image/svg+xml");
        const all = [...root.querySelectorAll("circle")].flatMap((one) => ["cx", "cy"].map((key) => one.getAttribute(key)));
        const strange = all.filter((text) => !Number.isFinite(Number(text)));
        return [root.querySelector("parsererror"), root.querySelectorAll(selector).length, strange];
      },
      [content.toString(), shapes],
    );
    assert.deepEqual([error, strange], [null, []]);
    assert.ok(expected === undefined ? count > 0 : count === expected, `${title}: ${count}`);
  }
});

test("what a zoomed chart does not show is cut off in its SVG", async () => {
  const chart = figure("Age and fitness of the living");
  const inside = await inPage(page, ({ charts: { byName } }) => {
    const { plot } = byName.ages;
    const { min, max } = plot.scales.x;
    plot.setScale("x", { min: min + 0.4 * (max - min), max: min + 0.6 * (max - min) });
    return [plot.over.clientWidth, plot.over.clientHeight];
  });
  const { content } = await saved(page, chart.getByRole("button", { name: "SVG" }));
  const [isOutside, ...shown] = await page.evaluate((text) => {
    const { documentElement: root } = new DOMParser().parseFromString(text, "image/svg+xml");
    const cut = root.querySelector(root.querySelector("[clip-path]").getAttribute("clip-path").slice(4, -1)).firstChild;
    const circles = [...root.querySelectorAll("circle")];
    const [width, height] = ["width", "height"].map((name) => Number(cut.getAttribute(name)));
    const isOutside = circles.some((one) => one.getAttribute("cx") < 0 || one.getAttribute("cx") > width);
    return [isOutside && circles.every((one) => one.closest("[clip-path]")), width, height];
  }, content.toString());
  assert.ok(isOutside);
  shown.forEach((size, i) => assert.ok(Math.abs(size - inside[i]) < 1, `${shown} for ${inside}`));
  await inPage(page, ({ charts: { byName } }) => byName.ages.draw());
});

test("a stacked chart leaves as CSV with the numbers behind its areas", async () => {
  const { content } = await saved(page, figure("How evaluations ended").getByRole("button", { name: "CSV" }));
  const [head, ...rows] = content.toString().trim().split("\n");
  const names = head.split(",");
  assert.deepEqual(names.slice(0, 4), ["generation", "ok", "invalid", "diverged"]);
  const query = "SELECT evaluations, invalid, diverged FROM generations ORDER BY generation";
  archived(scratch.run, query).forEach(([evaluations, invalid, diverged], i, all) => {
    const of = Object.fromEntries(rows[i].split(",").map((number, k) => [names[k], Number(number)]));
    assert.deepEqual([of.generation, of.invalid, of.diverged], [i, invalid, diverged]);
    const ended = names.slice(1).reduce((total, name) => total + of[name], 0);
    assert.equal(ended, evaluations - (i > 0 ? all[i - 1][0] : 0), rows[i]);
  });
});

test("the stage leaves as a picture", async () => {
  const { name, content } = await saved(page, page.getByRole("button", { name: "Save picture" }));
  assert.match(name, /^individual-\d+-[\d.]+-s\.png$/);
  assert.equal(content.subarray(1, 4).toString(), "PNG");
  const colours = await (await pixels(page, content)).evaluate(
    ({ data }) => new Set(Array.from({ length: data.length / 4 }, (_, i) => data.slice(4 * i, 4 * i + 3).join())).size,
  );
  assert.ok(colours > 50, `${colours} colours`);
});

test("the body leaves as JSON, as it is at that moment", async () => {
  await inPage(page, ({ viewer }) => viewer.seek(1.5));
  const { content } = await saved(page, page.getByRole("button", { name: "Save body" }));
  const shown = JSON.parse(content);
  const body = JSON.parse(evodevo("body", scratch.run, "--individual", String(shown.individual), "--matured"));
  assert.equal(shown.time, 1.5);
  assert.equal(shown.masses.length, body.masses.length);
  assert.equal(shown.springs.length, body.springs.length);
  const step = await inPage(page, ({ viewer }) => viewer.stages[0].life.robot.film.step);
  shown.masses.forEach((place, i) =>
    place.forEach((x, axis) => assert.ok(Math.abs(x - body.masses[i].position[axis]) <= 0.501 * step + 1e-5)),
  );
  const pair = ([a, b]) => `${Math.min(a, b)} ${Math.max(a, b)}`;
  const pairs = (springs) => springs.map(({ masses, a, b }) => pair(masses ?? [a, b])).sort();
  assert.deepEqual(pairs(shown.springs), pairs(body.springs));
});

test("a link restores the robots, the moment, the colour and the camera", async () => {
  await inPage(page, async ({ viewer }) => {
    await viewer.show(1, 0);
    viewer.setMode("stress");
    viewer.setView("front");
    viewer.seek(1.25);
  });
  await page.getByRole("button", { name: "Copy link" }).click();
  await until(page, () => location.hash.startsWith("#robot="));
  const state = ({ viewer }) => ({
    chosen: viewer.chosen,
    time: viewer.time,
    mode: viewer.mode,
    view: viewer.view,
    camera: viewer.camera.position.toArray().map((x) => x.toPrecision(3)),
  });
  const again = await opened(report, {}, { hash: new URL(page.url()).hash });
  const before = await inPage(page, state);
  assert.deepEqual([before.chosen, before.time, before.mode, before.view], [[1, 0], 1.25, "stress", "front"]);
  assert.deepEqual(await inPage(again, state), before);
  await inPage(again, ({ viewer }) => viewer.show(0));
  await again.evaluate(() => (location.hash = location.hash.replace("time=1.250", "time=0.500")));
  await until(again, ({ viewer: { chosen, time } }) => chosen.join() === "1,0" && time === 0.5);
  await again.close();
  const hash = "#robot=99&time=x&camera=1,2&colour=__proto__&view=constructor";
  await closed(await opened(report, {}, { hash }));
});

test("ancestors stand in a tree, whose pictures open robots", async () => {
  const shown = await inPage(page, ({ viewer }) => viewer.robots.map(({ robot }) => robot.individual));
  const line = archived(scratch.run,
    `WITH RECURSIVE line(id) AS (SELECT value FROM json_each('${JSON.stringify(shown)}') UNION
       SELECT parent FROM individuals JOIN line USING (id) WHERE parent IS NOT NULL)
     SELECT id, parent FROM line JOIN individuals USING (id) ORDER BY id`);
  const labels = await page.locator(".tree button").evaluateAll((all) => all.map((one) => one.getAttribute("aria-label")));
  assert.deepEqual(labels.map((label) => Number(/individual (\d+)/.exec(label)[1])), line.map(([id]) => id));
  assert.equal(await page.locator(".tree path").count(), line.filter(([, parent]) => parent !== null).length);
  const places = await page.locator(".tree button").evaluateAll((all) => all.map(({ style }) => style.left + style.top));
  assert.equal(new Set(places).size, line.length, "two stand at one place");
  const second = await inPage(page, ({ viewer }) => (viewer.show(0), viewer.robots[1].robot.individual));
  await page.locator(`.tree button[aria-label^="individual ${second}:"]`).click();
  await until(page, ({ viewer }, id) => viewer.stages[0].life.robot.individual === id, second);
});

test("a point of the living opens its robot, or says how to see it", async () => {
  const living = await inPage(page, ({ data, viewer, charts }) => {
    const { plot, data: columns } = charts.byName.ages;
    const { population } = data.runs[0];
    const shown = new Set(viewer.robots.map(({ robot }) => robot.individual));
    return population
      .filter(({ objectives }) => objectives.distance !== undefined)
      .map(({ id, objectives: { distance } }) => {
        const i = columns[1].indexOf(distance);
        return { id, isShown: shown.has(id), left: plot.valToPos(columns[0][i], "x"), top: plot.valToPos(distance, "y") };
      });
  });
  const over = figure("Age and fitness of the living").locator(".u-over");
  const click = async ({ left, top }) => {
    await over.click({ position: { x: left, y: top } });
    await inPage(page, () => {});
  };
  await click(living.find(({ isShown }) => !isShown));
  const notice = await page.locator(".notice").textContent();
  assert.match(notice, /evodevo report .* --individual \d+$/);
  assert.ok(living.some(({ id, isShown }) => !isShown && notice.endsWith(` ${id}`)), notice);
  const present = living.find(({ isShown }) => isShown);
  await inPage(page, ({ viewer }, id) => viewer.show(viewer.robots.findIndex(({ robot }) => robot.individual !== id)), present.id);
  await click(present);
  await until(page, ({ viewer }, id) => viewer.stages[0].life.robot.individual === id, present.id);
});
