// The stage of the report's page: what it shows of the way, its legend, and its controls.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { before, test } from "node:test";
import {
  archived, closed, cycles, cycleTime, differing, inPage, opened, picture, ran, reported, scratch, sum, until,
} from "./support.mjs";

const measuredFrom = cycles * cycleTime + 0.5;
let report, page;

before(async () => {
  report = reported(ran("run"));
  page = await opened(report);
});

const caption = (tab) => tab.locator(".caption span").first().textContent();

test("the caption says how far the robot has moved, of how much in all, and where to", async () => {
  const { individual, fitness } = await inPage(page, ({ viewer }) => {
    const { robot } = viewer.robots[0];
    return { individual: robot.individual, fitness: robot.objectives.distance };
  });
  assert.equal(archived(scratch.run, `SELECT value FROM scores WHERE individual = ${individual}`)[0][0], fitness);
  await inPage(page, ({ viewer }, time) => viewer.seek(time), measuredFrom - 0.1);
  assert.doesNotMatch(await caption(page), /body lengths/);
  await inPage(page, ({ viewer }) => viewer.seek(viewer.end));
  const [, now, all, metres, where] = /(-?[\d.]+) of (-?[\d.]+) body lengths \((-?[\d.]+) m\) (.*)$/.exec(await caption(page));
  assert.equal(now, all);
  assert.equal(where, "along +x");
  // the page knows positions, but not masses
  assert.ok(Math.abs(Number(all) - fitness) < 0.02 + 0.1 * Math.abs(fitness), `${all} of ${fitness}`);
  const length = await inPage(page, ({ viewer }) => viewer.stages[0].life.way.length);
  assert.ok(Math.abs(Number(metres) - Number(all) * length) < 0.011, `${metres} m`);
});

test("a fitness without a direction is measured where the robot went", async () => {
  const run = ran("anywhere", ["fitness.0.name=actuation-work", "experiment.verify=0"]);
  const tab = await opened(reported(run, "--best", "1"));
  const [total, moved] = await inPage(tab, ({ viewer }) => {
    const { life } = viewer.stages[0];
    const { begin, length, total } = life.way;
    const end = life.middleAt(life.end);
    return [total * length, Math.hypot(end[0] - begin.middle[0], end[1] - begin.middle[1])];
  });
  assert.ok(Math.abs(total - moved) < 1e-9, `${total} and ${moved} m`);
  await tab.close();
});

test("the track and the trail are drawn, and the trail grows", async () => {
  const lengths = await inPage(page, ({ viewer }, times) =>
    times.map((time) => {
      viewer.seek(time);
      viewer.draw();
      return viewer.stages[0].track.trail.geometry.drawRange.count;
    }), [measuredFrom, measuredFrom + 0.5, measuredFrom + 1]);
  assert.ok(lengths[0] === 0 && lengths[1] > 0 && lengths[2] > lengths[1], lengths.join());
  const shown = await picture(page);
  await inPage(page, ({ viewer }) => ((viewer.stages[0].track.root.visible = false), viewer.draw()));
  assert.ok(sum(await differing(shown, await picture(page))) > 100);
  await inPage(page, ({ viewer }) => ((viewer.stages[0].track.root.visible = true), viewer.draw()));
});

test("the ruler has the length that it says", async () => {
  await inPage(page, ({ viewer }) => (viewer.setView("side"), viewer.seek(viewer.end)));
  const [said, drawn] = await inPage(page, ({ viewer }) => {
    const [bar, text] = viewer.ruler.children;
    // the pixels of a metre along x at the robot, in the orthographic view from the side
    const { height, camera, orbit } = viewer;
    const metre = height / (2 * camera.position.distanceTo(orbit.target) * Math.tan((16 * Math.PI) / 180));
    return [Number.parseFloat(text.textContent), bar.getBoundingClientRect().width / metre];
  });
  assert.ok(Math.abs(drawn - said) < 0.05 * said, `${drawn} m is called ${said} m`);
  await inPage(page, ({ viewer }) => viewer.setView("perspective"));
});

test("the legend names exactly the materials that the robot's springs have", async () => {
  await page.locator(".modes label", { hasText: "Material" }).click();
  const used = await inPage(page, ({ viewer }) => {
    const { life, materialNames } = viewer.stages[0];
    const all = new Set(life.shots.flatMap(({ materials }) => [...materials]));
    return [...all].filter((i) => life.robot.film.materials[i].stiffness > 0).map((i) => materialNames[i] ?? null);
  });
  const named = await page.locator(".legend .swatch span").allTextContents();
  const explained = named.filter((text) => /^(glows|thick|trail|shown on the ground)/.test(text));
  const others = used.filter((name) => name === null).length;
  const mixtures = named.filter((text) => / mixtures? or changed materials?$/.test(text));
  assert.deepEqual(mixtures.map(Number.parseFloat), others > 0 ? [others] : []);
  const materials = named.filter((text) => !explained.includes(text) && !mixtures.includes(text));
  assert.deepEqual(materials.sort(), used.filter((name) => name !== null).sort());
  assert.equal(explained.length, 4, explained.join());
});

test("each view looks different, and orthographic ones keep parallels parallel", async () => {
  const seen = [];
  for (const view of ["in perspective", "from the side", "from the front", "from above"]) {
    await page.getByLabel("View").selectOption(view);
    seen.push(await picture(page));
  }
  for (let i = 1; i < seen.length; ++i) assert.ok(sum(await differing(seen[i - 1], seen[i])) > 200, String(i));
  await page.getByLabel("View").selectOption("in perspective");
});

test("masses on the ground have a colour of their own", async () => {
  // in an orthographic view from the side, with everything but masses hidden, only those at the bottom have it
  const heights = await inPage(page, ({ viewer }) => {
    viewer.setView("side");
    viewer.seek(viewer.end);
    viewer.setThick(true);
    const { life, masses, positions, scene } = viewer.stages[0];
    scene.traverse((object) => object.isMesh && (object.visible = object.geometry === masses));
    viewer.draw();
    const z = Array.from(life.shots.at(-1).masses, (mass) => positions.image.data[4 * mass + 2]);
    return { lowest: Math.min(...z), touch: life.touch, onGround: z.filter((height) => height <= life.touch).length };
  });
  assert.ok(heights.onGround > 0 && heights.onGround < 40, JSON.stringify(heights));
  const rows = await (await picture(page)).evaluate(({ data, width }) => {
    const found = [];
    for (let i = 0; i < data.length; i += 4)
      if (data[i + 1] > 1.5 * data[i] && data[i + 1] > 1.1 * data[i + 2]) found.push(Math.floor(i / 4 / width));
    return { count: found.length, first: Math.min(...found), last: Math.max(...found) };
  });
  assert.ok(rows.count > 10 && rows.last - rows.first < 40, JSON.stringify(rows));
  await inPage(page, ({ viewer }) => {
    viewer.stages[0].scene.traverse((object) => (object.visible = true));
    viewer.setThick(false);
    viewer.setView("perspective");
  });
});

test("thick springs cover more of the picture", async () => {
  await inPage(page, ({ viewer }) => viewer.seek(0.9));
  const thin = await picture(page);
  await page.getByLabel("Thick springs").check();
  const covered = sum(await differing(thin, await picture(page)));
  assert.ok(covered > 1000, `${covered} pixels`);
  await page.getByLabel("Thick springs").uncheck();
  assert.deepEqual(await differing(thin, await picture(page)), [0, 0]);
});

test("the wheel scrolls the page until the robot is clicked, and again after it has lost the focus", async () => {
  const tab = await opened(report);
  const stage = tab.locator(".stage canvas");
  await stage.hover();
  const state = () => inPage(tab, ({ viewer }) => [scrollY, viewer.camera.position.length()]);
  const wheel = async (by) => {
    await tab.mouse.wheel(0, by);
    await inPage(tab, () => {});
  };
  const [, far] = await state();
  await wheel(40);
  await until(tab, () => scrollY > 0);
  assert.equal((await state())[1], far);
  await stage.click({ position: { x: 300, y: 200 } });
  const [before] = await state();
  await wheel(-100);
  await until(tab, ({ viewer }, distance) => viewer.camera.position.length() < distance, far);
  assert.equal((await state())[0], before);
  await tab.getByLabel("Speed").focus();
  assert.equal(await inPage(tab, ({ viewer }) => viewer.orbit.enableZoom), false);
  await tab.close();
});

test("a click on a mass or a spring says what it is", async () => {
  await inPage(page, ({ viewer }) => (viewer.setView("perspective"), viewer.seek(0.3)));
  const texts = new Set();
  const canvas = page.locator(".stage canvas");
  const { width, height } = await canvas.boundingBox();
  for (let x = 0.3; x < 0.7; x += 0.04)
    for (let y = 0.3; y < 0.8; y += 0.05) {
      await canvas.click({ position: { x: x * width, y: y * height } });
      const picked = page.locator(".picked");
      if (await picked.isVisible()) texts.add(await picked.textContent());
    }
  const springs = [...texts].filter((text) => text.startsWith("Spring between masses "));
  const masses = [...texts].filter((text) => text.startsWith("Mass "));
  assert.ok(springs.length > 3 && masses.length > 0, [...texts].join("\n"));
  const { ends, count, stresses } = await inPage(page, ({ viewer }) => {
    const { life } = viewer.stages[0];
    const pairs = [...life.shots[0].springs].map((spring) => `${life.ends[2 * spring]} and ${life.ends[2 * spring + 1]}`);
    return { ends: pairs, count: life.shots[0].masses.length, stresses: life.robot.film.most_stress };
  });
  for (const text of springs) {
    assert.ok(ends.includes(/masses (\d+ and \d+):/.exec(text)[1]), text);
    assert.ok(Number(/([\d.]+) N in this one/.exec(text)[1]) <= stresses * 1.001, text);
  }
  for (const text of masses) assert.ok(Number(/Mass (\d+)/.exec(text)[1]) < count, text);
});

test("keys steer it, and arrows belong to the control that has the focus", async () => {
  const time = () => inPage(page, ({ viewer }) => viewer.time);
  await inPage(page, ({ viewer }) => viewer.seek(0));
  await page.getByLabel("Cycle of life").focus();
  await page.keyboard.press("ArrowRight");
  assert.equal(await time(), cycleTime);
  await inPage(page, ({ viewer }) => viewer.seek(0));
  await page.locator(".stage canvas").focus();
  await page.keyboard.press("]");
  assert.equal(await time(), cycleTime);
  await page.keyboard.press("Shift+ArrowRight");
  assert.equal(await time(), cycleTime + 1);
  await page.keyboard.press("ArrowRight");
  assert.ok(Math.abs((await time()) - cycleTime - 1 - 1 / 30) < 1e-9);
  await page.keyboard.press("f");
  assert.equal(await page.getByLabel("Follow").isChecked(), false);
  await page.keyboard.press("f");
});

test("it plays by itself, unless the reader prefers less motion", async () => {
  const [still, moving] = [page, await opened(report, { reducedMotion: "no-preference" })];
  assert.equal(await inPage(still, ({ viewer }) => viewer.playing), false);
  await until(moving, ({ viewer }) => viewer.playing && viewer.time > 0);
  await moving.close();
});

test("it fills the screen", async () => {
  await page.getByRole("button", { name: "Full screen" }).click();
  await until(page, ({ viewer }) => document.fullscreenElement === viewer.root);
  await page.evaluate(() => document.exitFullscreen());
});

test("without WebGL there are a still picture, a sentence, charts and tables", async () => {
  const withoutWebgl = () => {
    const context = HTMLCanvasElement.prototype.getContext;
    HTMLCanvasElement.prototype.getContext = function (kind, ...more) {
      return kind.startsWith("webgl") ? null : context.call(this, kind, ...more);
    };
  };
  const tab = await opened(report, {}, { before: withoutWebgl });
  assert.match(await tab.locator(".still").textContent(), /WebGL/);
  const coloured = await inPage(tab, () => {
    const canvas = document.querySelector(".still canvas");
    const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
    return data.filter((value, i) => i % 4 === 3 && value > 0).length;
  });
  assert.ok(coloured > 500, `${coloured} pixels`);
  assert.ok(await inPage(tab, ({ charts }) => charts.byName.evaluations.plot !== undefined));
  assert.ok((await tab.locator(".robots tbody tr").count()) > 0);
  assert.equal(await tab.locator(".viewer").count(), 0);
  await closed(tab);
});

test("verification stands in a table, in percent of the fitness", async () => {
  const { individual, verification } = await inPage(page, ({ viewer }) => viewer.robots[0].robot);
  const trials = archived(scratch.run, `SELECT trial, value FROM verifications WHERE individual = ${individual}`);
  assert.equal(trials.length, verification.trials.length);
  const rows = await page.locator(".verification tbody tr").evaluateAll((all) =>
    all.map((row) => [...row.children].map(({ textContent }) => textContent)),
  );
  assert.deepEqual(rows.map(([name]) => name).sort(), trials.map(([name]) => name).sort());
  const [, again] = rows.find(([name]) => name === "again");
  assert.match(again, /100 %, held$/);
});

test("axe finds nothing wrong, in light and in dark", async () => {
  const axe = readFileSync(join(process.env.EVODEVO_VIEWER, "node_modules/axe-core/axe.min.js"), "utf8");
  for (const colorScheme of ["light", "dark"]) {
    const tab = await opened(report, { colorScheme });
    await tab.addScriptTag({ content: axe });
    const { violations } = await tab.evaluate(() => axe.run());
    const found = violations.map(({ id, nodes }) => `${id}: ${nodes.map(({ html }) => html.slice(0, 120)).join(" | ")}`);
    assert.deepEqual(found, []);
    await tab.close();
  }
});
