// The report's page, in a browser.
import assert from "node:assert/strict";
import { cpSync, statSync } from "node:fs";
import { pathToFileURL } from "node:url";
import { before, test } from "node:test";
import {
  archived, barrenRun, closed, cycleTime, differing, evodevo, experimentName, inPage, launch, materialName, onPhone,
  opened, picture, ran, reported, scratch, sorted, sum, until, writeChanged,
} from "./support.mjs";

let report, page;

before(async () => {
  report = reported(ran("run"), "--individual", "0");
  page = await opened(report);
});

test("it opens from its file, fetches nothing, complains of nothing, and is no larger than it has to be", async () => {
  assert.deepEqual(page.requests.filter((url) => !url.startsWith("data:")), [pathToFileURL(report).href]);
  assert.deepEqual(page.complaints, []);
  assert.ok(statSync(report).size < 3_000_000);
});

test("it is drawn without complaint where there is neither a GPU nor Mesa", async () => {
  const software = await launch(["--use-angle=swiftshader"]);
  try {
    const drawn = await opened(report, {}, { within: software });
    const first = await picture(drawn);
    await inPage(drawn, ({ viewer }) => viewer.seek(2));
    assert.ok(sum(await differing(first, await picture(drawn))) > 200);
    assert.deepEqual(drawn.complaints, []);
  } finally {
    await software.close();
  }
});

test("charts hold the archive's numbers", async () => {
  const rows = archived(scratch.run,
    "SELECT evaluations, best, median, spring_evaluations, generation, diverged, invalid FROM generations ORDER BY generation");
  const [evaluations, ofSprings, statuses] = await inPage(page, ({ charts: { byName } }) =>
    [byName.evaluations, byName.springs, byName.statuses].map(({ data }) => data),
  );
  const column = (i) => rows.map((row) => row[i]);
  assert.deepEqual(evaluations, [column(0), column(1), column(2)]);
  let springs = 0;
  assert.deepEqual(ofSprings, [column(3).map((n) => (springs += n)), column(1), column(2)]);
  const count = rows.map((row, i) => row[0] - (i > 0 ? rows[i - 1][0] : 0));
  assert.deepEqual(statuses, [
    column(4),
    rows.map(() => 100),
    rows.map((r, i) => (100 * (r[5] + r[6])) / count[i]),
    rows.map((r, i) => (100 * r[5]) / count[i]),
  ]);
});

test("the chart of ages holds the living, and its front is what none of them beats", async () => {
  const last = archived(scratch.run, "SELECT max(generation) FROM generations")[0][0];
  const living = archived(scratch.run,
    `SELECT ${last} - origin, value FROM individuals JOIN scores ON id = individual WHERE died IS NULL AND objective = 0 AND status = 'ok'`);
  const [ages, dots, front] = await inPage(page, ({ charts }) => charts.byName.ages.data);
  const points = (values) => sorted(values.flatMap((value, i) => (value === null ? [] : [[Math.round(ages[i]), value]])));
  assert.ok(new Set(living.map(([age]) => age)).size < living.length);
  assert.deepEqual(points(dots), sorted(living));
  const unbeaten = living.filter(
    ([age, value]) => !living.some(([a, v]) => a <= age && v >= value && (a < age || v > value)),
  );
  const distinct = unbeaten.filter(([age, value], i) => unbeaten.findIndex(([a, v]) => a === age && v === value) === i);
  assert.deepEqual(points(front), sorted(distinct));
});

test("where there is nothing to choose, there are no choices, and no tests where there are no scenarios", async () => {
  assert.equal(await page.locator(".choosers").count(), 0);
  assert.equal(await page.locator(".tests").count(), 0);
  const caption = await page.locator("figcaption").nth(2).textContent();
  assert.equal(caption, "Age and fitness of the living, and the front of the best");
});

test("it says where the time went", async () => {
  const recorded = Number(archived(scratch.run, "SELECT value FROM record WHERE key = 'seconds_simulate'")[0][0]);
  assert.ok(recorded > 0);
  assert.equal(await inPage(page, ({ data }) => data.runs[0].time.simulate), recorded);
  const named = await page.locator(".bar > span:first-child").allTextContents();
  assert.deepEqual(named, ["simulate", "develop", "decode", "archive"]);
});

test("it says what limits the speed of robots, and how near the best came to it", async () => {
  const { length, speed, limit } = await inPage(page, ({ data }) => data.runs[0].top_speed);
  assert.ok(Math.abs(limit - (0.5 * 9.81) / 20.100671707002873) < 1e-9);
  assert.ok(length > 0 && speed > 0);
  const shown = await page.locator(".fact", { hasText: "Top speed" }).textContent();
  assert.match(shown, /0\.244 m\/s/);
  assert.ok(shown.endsWith(` ${Math.round((100 * speed) / limit)} %`), shown);
});

test("it shows whom verification before the front has refused", async () => {
  const run = ran("verified", ["experiment.verify_front=trials"]);
  const verified = await opened(reported(run, "--best", "1"));
  const rows = archived(run, "SELECT artefact, passive FROM generations ORDER BY generation"); // none are lucky
  const counts = [0, 1].map((i) => sum(rows.map((row) => row[i])));
  assert.ok(sum(counts) > 0);
  const facts = await verified.locator(".fact", { hasText: "Ended well" }).textContent();
  const { labels, top } = await inPage(verified, ({ charts }) => {
    const { data, plot } = charts.byName.statuses;
    return { labels: plot.series.slice(1).map(({ label }) => label), top: data.at(-1) };
  });
  ["artefact", "passive"].forEach((status, i) => {
    assert.equal(facts.includes(`${counts[i]} ${status}`), counts[i] > 0, facts);
    assert.equal(labels.includes(status), counts[i] > 0, labels.join());
  });
  const last = labels.at(-1) === "passive" ? 1 : 0;
  const newborns = archived(run, "SELECT count(*) FROM individuals GROUP BY born ORDER BY born").map(([n]) => n);
  assert.deepEqual(top, rows.map((row, i) => (100 * row[last]) / newborns[i]));
  assert.equal(await verified.locator(".bar > span:first-child").last().textContent(), "verify");
  const { verdict } = await inPage(verified, ({ data }) => data.runs[0].best.verification);
  assert.match(verdict, /^(verified|artefact|passive)/);
  assert.ok((await verified.locator(".fact", { hasText: "The best, verified" }).textContent()).endsWith(verdict));
  await closed(verified);
});

test("its menu has each life of the best, each with its own score and film, and its table has the robot once", async () => {
  const run = ran("lives", ["experiment.lives=3", "experiment.birth_noise=0.02", "development.draws_between_lives=new"]);
  const living = await opened(reported(run, "--best", "1"));
  const [[best]] = archived(run, "SELECT individual FROM scores WHERE objective = 0 ORDER BY value DESC, individual LIMIT 1");
  const scores = archived(run, `SELECT value FROM life_scores WHERE individual = ${best} AND objective = 0 ORDER BY life`);
  assert.equal(scores.length, 3);
  const menu = await living.locator(".pickers select").first().locator("option").allTextContents();
  const own = menu.filter((text) => text.includes(`individual ${best},`));
  assert.deepEqual(own.map((text) => /life (\d)/.exec(text)?.[1]), ["1", "2", "3"]);
  const said = own.map((text) => /life \d, (.*)/.exec(text)[1]);
  assert.equal(new Set(said).size, 3, said.join());
  const shown = await inPage(living, ({ viewer }) =>
    viewer.robots.slice(0, 3).map(({ robot }) => robot.lives[robot.life - 1].distance));
  assert.deepEqual(shown, scores.flat());
  const ends = await inPage(living, async ({ viewer }) => {
    const bodies = [];
    for (const life of [0, 1, 2]) {
      await viewer.show(life);
      bodies.push(JSON.stringify(viewer.stages[0].life.robot.film.shots.at(-1)));
    }
    return bodies;
  });
  assert.equal(new Set(ends).size, 3);
  const rows = await living.locator(".table.robots tbody tr").allTextContents();
  assert.equal(rows.filter((text) => text.startsWith("best")).length, 1);
  assert.deepEqual(living.complaints, []);
  await closed(living);
});

test("a name with markup in it is shown as text", async () => {
  assert.equal(await page.locator("h1").textContent(), experimentName);
  assert.ok((await page.locator(".looks .legend").textContent()).includes(materialName));
  assert.ok((await page.locator("pre").textContent()).includes("[materials."));
  assert.equal(await page.evaluate(() => window.harmed), undefined);
  assert.equal(await page.locator("img").count(), 0);
});

test("what is pressed before the robot is there does no harm; play goes on in time, and stops at the end", async () => {
  const before = () => {
    const press = () => ["]", " ", "ArrowLeft"].forEach((key) => document.dispatchEvent(new KeyboardEvent("keydown", { key })));
    const pressing = setInterval(() => (window.evodevo?.then(() => clearInterval(pressing)), press()));
  };
  const early = await opened(report, {}, { before });
  await inPage(early, ({ viewer }) => (viewer.pause(), viewer.setSpeed(4), viewer.seek(viewer.end - 0.5)));
  await early.getByRole("button", { name: "Play" }).click();
  await until(early, ({ viewer }) => viewer.time === viewer.end && !viewer.playing);
  await closed(early);
});

test("muscles a whole number of turns apart have the same colour", async () => {
  const legendOf = (of) => of.locator(".looks .legend").evaluate((legend) => legend.innerHTML);
  await inPage(page, ({ viewer }) => (viewer.show(0), viewer.setMode("material")));
  for (const turns of [-1, 3]) {
    const turned = (material) => ({ ...material, phase: material.phase + 2 * Math.PI * turns + 1e-9 });
    writeChanged(report, scratch.path("turned.html"), (data) => {
      for (const { robots } of data.runs) for (const { film } of robots) film.materials = film.materials?.map(turned);
      return data;
    });
    const other = await opened(scratch.path("turned.html"));
    assert.equal(await legendOf(other), await legendOf(page), `${turns} turns`);
    await other.close();
  }
});

test("each colour mode looks different and says what it shows", async () => {
  await inPage(page, ({ viewer }) => viewer.seek(1.4));
  const seen = [];
  for (const [mode, words] of [
    ["Material", materialName],
    ["Stress", " N"],
    ["Came in", "there from birth"],
  ]) {
    await page.locator(".modes label", { hasText: mode }).click();
    await inPage(page, () => {});
    assert.ok((await page.locator(".looks .legend").textContent()).includes(words));
    seen.push(await picture(page));
  }
  for (const [a, b] of [[0, 1], [1, 2], [0, 2]])
    assert.ok(sum(await differing(seen[a], seen[b])) > 200, `${a} and ${b}`);
});

test("stress is between nothing and the most, which a spring of the life bears", async () => {
  const [least, most, levels] = await inPage(page, ({ viewer }) => {
    const { life } = viewer.stages[0];
    const all = life.shots.flatMap(({ stress }) => [...stress]);
    return [Math.min(...all), Math.max(...all), life.robot.film.stress_levels];
  });
  assert.ok(least >= 0 && least < levels);
  assert.equal(most, levels);
  assert.match(await page.locator(".viewer .note").textContent(), /mm always; stress to within [\d.]+ N\.$/);
});

/** Returns the number of pixels with the amber colour of new springs. */
const amber = (pixels) =>
  pixels.evaluate(({ data }) => {
    let count = 0;
    for (let i = 0; i < data.length; i += 4)
      if (data[i] > 150 && data[i] > 1.2 * data[i + 1] && data[i + 1] > 2.5 * data[i + 2]) ++count;
    return count;
  });

test("the life slider goes to cycles, where vanished springs fade and new ones light up", async () => {
  await page.locator(".modes label", { hasText: "Came in" }).click();
  await page.getByLabel("Cycle of life").fill("1");
  assert.equal(await page.locator(".cycle-name").textContent(), "cycle 2");
  const [time, gone, came] = await inPage(page, ({ viewer }) => {
    const shot = viewer.stages[0].life.shots[1];
    return [viewer.time, shot.gone.length, shot.came];
  });
  assert.equal(time, cycleTime);
  assert.ok(gone >= 6 && came >= 6, `${gone} and ${came}`);
  assert.ok((await page.locator(".caption").first().textContent()).includes(`${gone} removed, ${came} new`));
  const at = await amber(await picture(page));
  await inPage(page, ({ viewer }) => viewer.seek(0.999));
  const later = await amber(await picture(page));
  assert.ok(at > 50 + 5 * later, `${at} then ${later}`);
  const opacity = async (time) => {
    await inPage(page, ({ viewer }, at) => viewer.seek(at), time);
    return inPage(page, ({ viewer }) => viewer.stages[0].goneMaterial.uniforms.opacity.value);
  };
  assert.ok((await opacity(0.5)) > 0.5 && (await opacity(0.999)) < 0.01);
});

test("two robots stand side by side, in step", async () => {
  await page.getByLabel("beside").selectOption("1");
  await until(page, ({ viewer }) => viewer.stages.length === 2);
  await inPage(page, ({ viewer }) => viewer.seek(1.0));
  const captions = await page.locator(".caption span").allTextContents();
  assert.ok(captions.length === 2 && captions.every((text) => text.startsWith("cycle 3")), captions.join("; "));
  const both = await picture(page);
  await inPage(page, ({ viewer }) => viewer.seek(2.5));
  for (const count of await differing(both, await picture(page))) assert.ok(count > 100);
  await page.locator(".modes label", { hasText: "Stress" }).click();
  const most = await inPage(page, ({ viewer }) => viewer.stages.map(({ life }) => life.robot.film.most_stress));
  const legend = await page.locator(".looks .legend").textContent();
  assert.equal(Number.parseFloat(legend.slice("0 N".length)), Number(Math.max(...most).toPrecision(4)), legend);
  await page.getByLabel("beside").selectOption("");
  await until(page, ({ viewer }) => viewer.stages.length === 1);
});

test("it fits a phone, where a finger turns the robot", async () => {
  const phone = await onPhone(report);
  const stage = await phone.$(".stage canvas");
  await stage.scrollIntoViewIfNeeded();
  const box = await stage.boundingBox();
  const before = await inPage(phone, ({ viewer }) => viewer.camera.position.toArray());
  const finger = await phone.context().newCDPSession(phone);
  const touch = (type, ...touchPoints) => finger.send("Input.dispatchTouchEvent", { type, touchPoints });
  const y = box.y + box.height / 2;
  await touch("touchStart", { x: 200, y });
  for (const x of [190, 170, 140, 110]) await touch("touchMove", { x, y });
  await touch("touchEnd");
  const turned = await inPage(phone, ({ viewer }) => viewer.camera.position.toArray());
  assert.ok(Math.hypot(...turned.map((x, i) => x - before[i])) > 0.1);
  await closed(phone);
});

/** Is executed in the page. Returns the height of a life's lowest mass above the drawn ground at a time, m. */
function gap({ viewer }, time) {
  const { life, floor } = viewer.stages[0];
  const { array } = floor.geometry.attributes.position;
  let columns = 1;
  while (array[3 * columns + 1] === array[1]) ++columns;
  const spacing = array[3] - array[0];
  const positions = new Float32Array(4 * life.massCount);
  life.writePositions(time, positions);
  const above = Array.from(life.shots[life.shotAt(time)].masses, (mass) => {
    const [x, y, z] = positions.subarray(4 * mass);
    const u = (x - array[0]) / spacing;
    const v = (y - array[1]) / spacing;
    const height = (i, j) => array[3 * (columns * (Math.floor(v) + j) + Math.floor(u) + i) + 2];
    const row = (j) => height(0, j) + (u % 1) * (height(1, j) - height(0, j));
    return z - row(0) - (v % 1) * (row(1) - row(0));
  });
  return Math.min(...above);
}

test("rough ground is drawn where bodies stand on it, and slopes lean", async () => {
  const roughness = 0.2;
  const scene = [`floor.roughness=${roughness}`, "floor.wavelength=0.8", "gravity.slope=10"];
  const hills = await opened(reported(ran("hills", [...scene.map((key) => `scene.${key}`), "simulation.dt=auto"])));
  const robots = await inPage(hills, ({ viewer }) => viewer.robots.length);
  for (let i = 0; i < robots; ++i) {
    await inPage(hills, ({ viewer }, robot) => viewer.show(robot), i);
    // bodies touch the ground at birth; sampling loses up to 1/25 of the roughness, and rounding 1/254
    assert.ok(Math.abs(await inPage(hills, gap, 0)) < 0.05 * roughness, `robot ${i}`);
    assert.ok((await inPage(hills, gap, 3)) > -0.1 * roughness, `robot ${i}`);
  }
  const downhill = await inPage(hills, ({ viewer }) => viewer.stages[0].scene.matrixWorld.elements.slice(0, 3));
  assert.ok(Math.abs(downhill[2] + Math.sin((10 * Math.PI) / 180)) < 1e-6, `+x points to ${downhill}`);
  const shown = await picture(hills);
  await inPage(hills, ({ viewer }) => ((viewer.stages[0].floor.visible = false), viewer.draw()));
  assert.ok(sum(await differing(shown, await picture(hills))) > 5000);
  await closed(hills);
});

test("several runs give one page that compares them", async () => {
  const other = scratch.path("other");
  evodevo("run", scratch.file, "--out", other, "--seed", "8");
  const both = await opened(reported(scratch.run, other, "--best", "1"));
  const labels = await inPage(both, ({ charts }) => charts.byName.evaluations.plot.series.map((s) => s.label));
  assert.deepEqual(labels.slice(1), ["run best", "run median", "other best", "other median"]);
  const best = (folder) => archived(folder, "SELECT best FROM generations ORDER BY generation").map(([value]) => value);
  const data = await inPage(both, ({ charts }) => charts.byName.evaluations.data);
  assert.deepEqual([data[1], data[3]], [best(scratch.run), best(other)]);
  const heads = await both.locator(".facts-of-runs thead th").allTextContents();
  assert.deepEqual(heads, ["Fact", `run ${experimentName}, seed 3`, `other ${experimentName}, seed 8`]);
  const most = archived(other, "SELECT max(value) FROM scores")[0][0];
  const row = both.locator(".facts-of-runs tbody tr", { hasText: "Best distance" });
  assert.equal(Number.parseFloat(await row.locator("td").nth(1).textContent()), Number(most.toPrecision(4)));
  await closed(both);
});

test("what was measured of a run stands on its page, as text", async () => {
  const run = scratch.path("measured");
  cpSync(scratch.run, run, { recursive: true });
  archived(run, `INSERT INTO signal VALUES(0, 'random', 'repeatability', 'one life', 'rank', 0.75, 0.5, 1, 60)`);
  archived(run, `INSERT INTO signal VALUES(1, 'last', '<b>odd</b>', 'all', 'share', 0.25, NULL, NULL, 9)`);
  const measured = await opened(reported(run, "--best", "1"));
  const rows = measured.locator(".signal tbody tr");
  assert.deepEqual(await rows.nth(0).locator("td").allTextContents(),
    ["random", "repeatability", "one life", "rank", "0.75", "0.5 to 1", "60"]);
  assert.equal((await rows.nth(1).locator("td").allTextContents())[1], "<b>odd</b>");
  assert.equal((await rows.nth(1).locator("td").allTextContents())[5], "–");
  assert.ok((await measured.locator(".signal p").count()) > 0);
  await closed(measured);
  const not = await opened(reported(scratch.run, "--best", "1"));
  assert.equal(await not.locator(".signal").count(), 0);
  await closed(not);
});

test("where nothing ended with a fitness, charts say so", async () => {
  const barren = await opened(reported(barrenRun().run, "--individual", "0"));
  assert.equal(await barren.getByText("no individual has ended with a fitness").count(), 3);
  assert.ok((await barren.locator(".caption").first().textContent()).includes("invalid: no body"));
  await closed(barren);
});

for (const [what, low, high] of [
  ["are equal", 1, 1],
  ["differ by a rounding error", 1 - 2 ** -53, 1],
  ["are huge", 1e300, 1.5e300],
  ["are tiny", 1e-300, 2e-300],
])
  test(`charts have some ticks, and can be saved, where scores ${what}`, async () => {
    const run = scratch.path(what);
    cpSync(scratch.run, run, { recursive: true });
    const value = (number) => `CASE WHEN ${number} % 2 = 0 THEN ${low} ELSE ${high} END`;
    archived(run, `UPDATE scores SET value = ${value("individual")}`);
    archived(run, `UPDATE generations SET best = ${high}, median = ${value("generation")}`);
    const narrow = await opened(reported(run, "--individual", "0"));
    const ticks = await inPage(narrow, ({ charts }) =>
      Object.values(charts.byName).flatMap(({ plot, saving }) => {
        plot.setScale("x", { min: 1, max: 1 + 2 ** -52 }); // as by zooming in
        saving.querySelector("button").click();
        return plot.axes.map(({ _splits }) => _splits?.length ?? 0);
      }),
    );
    assert.ok(Math.max(...ticks) < 50, ticks.join());
    await closed(narrow);
  });
