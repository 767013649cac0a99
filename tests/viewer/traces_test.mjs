// The charts of a picked spring or mass over the life.
import assert from "node:assert/strict";
import { before, test } from "node:test";
import { cycleTime, inPage, opened, ran, reported, saved } from "./support.mjs";

let page;

before(async () => {
  // voxels, whose springs are short and bear much, so that their forces are far above the rounding of positions
  const run = ran("run", ["experiment.verify=0", "encoding={name='voxel', size=[3, 4, 2], edge=0.11}"]);
  page = await opened(reported(run), { acceptDownloads: true, viewport: { width: 1180, height: 900 } });
});

/** Picks a mass or a spring of the first robot. */
const pick = (what) =>
  inPage(page, ({ viewer }, picked) => {
    viewer.pick = { stage: viewer.stages[0], ...picked };
    viewer.seek(viewer.time);
  }, what);

/** The springs that are there in the first shot, but not in the last one. */
const vanishing = () =>
  inPage(page, ({ viewer }) => {
    const { shots } = viewer.stages[0].life;
    return [...shots[0].springs].filter((spring) => !shots.at(-1).springs.includes(spring));
  });

test("the mean of the absolute force of a spring is its stress, in every shot in which it is there", async () => {
  const compared = await inPage(page, ({ viewer }) => {
    const [stage] = viewer.stages;
    const { life } = stage;
    const rows = [];
    for (const spring of life.shots[0].springs) {
      viewer.traces.show({ stage, spring });
      const [times, forces] = viewer.traces.force.data;
      for (const shot of life.shots) {
        const place = shot.springs.indexOf(spring);
        const first = times.findIndex((time, i) => time >= shot.begin && times[i + 1] > time && forces[i] !== null);
        if (place < 0) continue;
        let [sum, at] = [0, first];
        for (; at + 1 < times.length && times[at + 1] <= shot.end && times[at + 1] > times[at]; ++at)
          sum += ((Math.abs(forces[at]) + Math.abs(forces[at + 1])) / 2) * (times[at + 1] - times[at]);
        const [force, stress] = [sum / (times[at] - times[first]), life.stressOf(shot, place)];
        if (stress > 3 * viewer.traces.error) rows.push([force, stress]);
      }
    }
    return rows;
  });
  assert.ok(compared.length > 300, `${compared.length}`);
  const off = compared.map(([force, stress]) => Math.abs(force - stress) / stress).sort((a, b) => a - b);
  // the page holds 30 of the 500 to 2,000 moments of a second
  assert.ok(off[Math.floor(0.5 * off.length)] < 0.03, `half are off by up to ${off[Math.floor(0.5 * off.length)]}`);
  assert.ok(off[Math.floor(0.9 * off.length)] < 0.15, `nine of ten by up to ${off[Math.floor(0.9 * off.length)]}`);
});

test("a spring that vanishes has no force afterwards, and the axis shows the whole life", async () => {
  const [spring] = await vanishing();
  await pick({ spring });
  const { times, values, lost, ends, axis } = await inPage(page, ({ viewer }, number) => {
    const { shots, begin, end } = viewer.stages[0].life;
    const { data, plot } = viewer.traces.force;
    const [times, values] = data;
    const lost = shots.find(({ springs }) => !springs.includes(number)).begin;
    return { times, values, lost, ends: [begin, end], axis: [plot.scales.x.min, plot.scales.x.max] };
  }, spring);
  assert.ok(Math.abs(lost % cycleTime) < 1e-9 && lost > 0, `${lost} s`);
  times.forEach((time, i) => {
    if (time < lost) assert.ok(Number.isFinite(values[i]), `${values[i]} N at ${time} s`);
    if (time > lost) assert.equal(values[i], null, `at ${time} s`);
  });
  assert.deepEqual(axis, ends);
});

test("the marker is at the moment that is shown", async () => {
  const [spring] = await vanishing();
  await pick({ spring });
  for (const part of [0.13, 0.71]) {
    const [marked, shown] = await inPage(page, ({ viewer }, at) => {
      viewer.seek(viewer.begin + at * (viewer.end - viewer.begin));
      const [marker, over] = [".moment", ".u-over"].map((name) => viewer.traces.root.querySelector(`figure:not([hidden]) ${name}`));
      const [mark, box] = [marker, over].map((one) => one.getBoundingClientRect());
      return [(mark.left + mark.width / 2 - box.left) / box.width, at];
    }, part);
    assert.ok(Math.abs(marked - shown) < 0.01, `${marked} and not ${shown} of the width`);
  }
});

/** Clicks a button of the chart that is seen, and returns the name and the text of the file that it saves. */
async function savedBy(name) {
  const file = await saved(page, page.locator(".traces figure:visible").getByRole("button", { name }));
  return [file.name, file.content.toString()];
}

test("the chart leaves as CSV and, with its gaps, as SVG", async () => {
  const springs = await vanishing();
  await pick({ spring: springs[0] });
  const [name, content] = await savedBy("Save CSV");
  const [a, b] = await inPage(page, ({ viewer }, s) => [...viewer.stages[0].life.ends.slice(2 * s, 2 * s + 2)], springs[0]);
  assert.equal(name, `Force-of-the-spring-between-masses-${a}-and-${b}.csv`);
  const [head, ...rows] = content.trim().split("\n");
  assert.equal(head, "time (s),force");
  assert.deepEqual(rows, await inPage(page, ({ viewer }) => {
    const [times, values] = viewer.traces.force.data;
    return times.map((time, i) => `${time},${values[i] ?? ""}`);
  }));
  // a chart with a gap amid the life is not joined over it
  await inPage(page, ({ viewer }) => {
    const { force } = viewer.traces;
    const [times, values] = force.data;
    const middle = Math.floor(values.indexOf(null) / 2);
    values[middle] = null;
    force.plot.setData([times, values]);
  });
  const [, svg] = await savedBy("Save SVG");
  const [, line] = /<path d="([^"]*)" fill="none" stroke="#/.exec(svg);
  assert.equal(line.match(/M/g).length, 2, line);
});

test("a mass has a speed and a height", async () => {
  await inPage(page, ({ viewer }) => viewer.seek(0));
  await pick({ mass: 7 });
  const chart = page.locator(".traces figure:visible");
  assert.equal(await chart.locator("figcaption").textContent(), "Speed of mass 7");
  const path = await inPage(page, ({ viewer }) => {
    const { life } = viewer.stages[0];
    const [times, speeds] = viewer.traces.motion.data;
    const at = times.findIndex((time) => time > 1.01);
    const out = new Float32Array(4 * life.massCount);
    const place = (time) => (life.writePositions(time, out), [...out.subarray(28, 31)]);
    const half = 0.001; // s
    const [p, q] = [place(times[at] - half), place(times[at] + half)];
    return [Math.hypot(...p.map((x, axis) => q[axis] - x)) / (2 * half), speeds[at]];
  });
  assert.ok(Math.abs(path[0] - path[1]) < 0.01 + 0.02 * path[0], path.join(" and "));
  await chart.getByLabel("Quantity").selectOption("height (m)");
  assert.equal(await chart.locator("figcaption").textContent(), "Height of mass 7");
  const heights = await inPage(page, ({ viewer }) => {
    const [times, values] = viewer.traces.motion.data;
    const at = times.findIndex((time) => time > 0.73);
    viewer.seek(times[at]);
    viewer.draw();
    return [viewer.stages[0].positions.image.data[4 * 7 + 2], values[at]];
  });
  assert.ok(Math.abs(heights[0] - heights[1]) < 1e-5, heights.join(" and "));
});

test("the chart stands beside the stage, below it on a phone, and goes with what was picked", async () => {
  await pick({ mass: 7 });
  const places = () =>
    inPage(page, ({ viewer }) => [viewer.stage, viewer.traces.root].map((one) => one.getBoundingClientRect().toJSON()));
  const [stage, chart] = await places();
  assert.ok(chart.left >= stage.right - 1 && chart.width > 200 && stage.width > 400, JSON.stringify([stage, chart]));
  await page.setViewportSize({ width: 390, height: 800 });
  const [above, below] = await places();
  assert.ok(below.top >= above.bottom - 1 && below.right <= 390, JSON.stringify([above, below]));
  await page.setViewportSize({ width: 1180, height: 900 });
  await inPage(page, ({ viewer }) => viewer.show(1));
  assert.equal(await page.locator(".traces").isVisible(), false);
  await inPage(page, ({ viewer }) => viewer.show(0));
});
