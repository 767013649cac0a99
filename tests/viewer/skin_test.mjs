// The skins of bodies of voxels.
import assert from "node:assert/strict";
import { before, test } from "node:test";
import { closed, differing, evodevo, inPage, opened, picture, ran, reported, scratch, sum } from "./support.mjs";

const edge = 0.11; // m
let page;

before(async () => {
  const encoding = `encoding={name='voxel', size=[3, 4, 2], edge=${edge}}`;
  page = await opened(reported(ran("run", [encoding, "development.operator.0.springs=73", "experiment.verify=0"])));
});

const skinBox = (tab) => tab.getByLabel("Skin", { exact: true });
const pairOf = (a, b) => `${Math.min(a, b)} ${Math.max(a, b)}`;
const neighbours = ([x, y, z]) => [[x - 1, y, z], [x + 1, y, z], [x, y - 1, z], [x, y + 1, z], [x, y, z - 1], [x, y, z + 1]];

/** Returns the voxels of a robot of a run at birth, from its body as the command `body` prints it: the place of each in the
 *  lattice and its corners. A body diagonal joins two corners that belong to no other voxel together. */
function voxelsOf(individual, run = scratch.run) {
  const { masses, springs } = JSON.parse(evodevo("body", run, "--individual", String(individual)));
  const low = [0, 1, 2].map((axis) => Math.min(...masses.map(({ position }) => position[axis])));
  const places = masses.map(({ position }) => position.map((x, axis) => Math.round((x - low[axis]) / edge)));
  const massAt = new Map(places.map((place, i) => [place.join(), i]));
  const joined = new Set(springs.map(({ a, b }) => pairOf(a, b)));
  const corner = (at, bits) => massAt.get(at.map((x, axis) => x + ((bits >> axis) & 1)).join());
  return places
    .map((at) => ({ at, corners: [0, 1, 2, 3, 4, 5, 6, 7].map((bits) => corner(at, bits)) }))
    .filter(({ corners }) => [0, 1, 2, 3].every((i) => joined.has(pairOf(corners[i], corners[7 - i]))));
}

/** Returns the number of outer faces of the voxels that have more than half of their 28 springs. */
function facesOf(voxels, pairs, masses) {
  const isWhole = ({ corners }) =>
    corners.every((mass) => masses.has(mass)) &&
    corners.flatMap((a, i) => corners.slice(0, i).map((b) => pairOf(a, b))).filter((pair) => pairs.has(pair)).length > 14;
  const whole = voxels.filter(isWhole);
  const there = new Set(whole.map(({ at }) => at.join()));
  return { whole: whole.length, faces: sum(whole.map(({ at }) => neighbours(at).filter((next) => !there.has(next.join())).length)) };
}

/** Is executed in the page. Returns of each shot of the first robot: the number of faces of its skin, that of the springs
 *  that are drawn, and the springs and masses that are there. */
function shotsOf({ viewer }) {
  const [stage] = viewer.stages;
  const { ends, shots } = stage.life;
  return shots.map(({ begin, springs, masses }) => {
    viewer.seek(begin);
    viewer.draw();
    return {
      faces: stage.skin.getAttribute("position").count / 4,
      drawn: stage.springs.getAttribute("position").count / 4,
      pairs: [...springs].map((spring) => [...ends.slice(2 * spring, 2 * spring + 2)]),
      masses: [...masses],
    };
  });
}

/** The voxels of the first robot of a page, the shots of its life, and what the skin must have in each. */
async function expectedOf(tab, run) {
  await skinBox(tab).check();
  const voxels = voxelsOf(await inPage(tab, ({ viewer }) => viewer.robots[0].robot.individual), run);
  const shots = await inPage(tab, shotsOf);
  const of = ({ pairs, masses }) => facesOf(voxels, new Set(pairs.map(([a, b]) => pairOf(a, b))), new Set(masses));
  return { voxels, shots, counts: shots.map(of) };
}

test("in each cycle the skin has the outer faces of the voxels that are there", async () => {
  const { voxels, shots, counts } = await expectedOf(page);
  assert.ok(voxels.length > 8 && voxels.length < 24, `${voxels.length} voxels`);
  assert.deepEqual(shots.map(({ faces }) => faces), counts.map(({ faces }) => faces));
  assert.equal(counts[0].whole, voxels.length);
  assert.ok(counts.at(-1).whole < voxels.length, "no voxel has come apart, so this tests less than it should");
});

test("a face has the colour of the material inside its voxel, and the legend names it", async () => {
  const { faces, named } = await inPage(page, ({ viewer }) => {
    viewer.setMode("material");
    viewer.seek(0);
    viewer.draw();
    const colour = viewer.stages[0].skin.getAttribute("colour").array;
    const swatches = [...document.querySelectorAll(".legend .swatch")];
    const named = swatches.map((one) => [one.textContent, getComputedStyle(one.firstChild).backgroundColor]);
    const css = (at) => `rgb(${[0, 1, 2].map((k) => Math.round(255 * colour[at + k])).join(", ")})`;
    return { named, faces: [...new Set(Array.from({ length: colour.length / 12 }, (_, i) => css(12 * i)))] };
  });
  const known = new Map(named.map(([text, colour]) => [colour, text]));
  assert.ok(faces.length > 1, "only one material");
  for (const face of faces) assert.match(known.get(face) ?? "none", /^(muscle|muscle2|tissue|bone|<\/script>.*)$/, `${face}: ${JSON.stringify(named)}`);
  assert.ok(named.some(([text]) => text.startsWith("a face: ")));
});

test("a skin hides the springs, and moves with the masses", async () => {
  const at = async (time, isOn) => {
    await skinBox(page).setChecked(isOn);
    await inPage(page, ({ viewer }, moment) => (viewer.setFollow(false), viewer.seek(moment), viewer.draw()), time);
    return picture(page);
  };
  const [bare, covered, later] = [await at(0.2, false), await at(0.2, true), await at(0.4, true)];
  assert.ok(sum(await differing(bare, covered)) > 3000, "nothing covers the springs");
  // without the faces, what is left is a part of the springs alone
  await inPage(page, ({ viewer }) => {
    const { scene, skin } = viewer.stages[0];
    scene.traverse((object) => object.isMesh && object.geometry === skin && (object.visible = false));
    viewer.seek(0.2);
    viewer.draw();
  });
  assert.ok(sum(await differing(covered, await picture(page))) > 3000, "the faces are not what covers");
  const [drawn, all] = await inPage(page, ({ viewer }) => {
    const { springs, life, scene } = viewer.stages[0];
    scene.traverse((object) => (object.visible = true));
    return [springs.getAttribute("position").count / 4, life.shots[0].springs.length];
  });
  assert.equal(drawn, 0, `${drawn} of ${all} springs are drawn, though faces cover them`);
  assert.ok(sum(await differing(covered, later)) > 100, "it does not move");
  await inPage(page, ({ viewer }) => viewer.setFollow(true));
});

test("S covers and uncovers", async () => {
  await page.locator(".stage canvas").focus();
  for (const covered of [await skinBox(page).isChecked(), !(await skinBox(page).isChecked())]) {
    await page.keyboard.press("s");
    assert.equal(await skinBox(page).isChecked(), !covered);
  }
});

test("a skin covers voxels whose springs act in parallel to those of their neighbours", async () => {
  const encoding = "encoding={name='voxel', size=[3, 2, 2], edge=0.11, springs='own'}";
  const run = ran("parallel", [encoding, "simulation.dt='auto'", "experiment.evaluations=12", "experiment.verify=0"]);
  const tab = await opened(reported(run, "--best", "1"));
  const { voxels, shots, counts } = await expectedOf(tab, run);
  assert.ok(voxels.length > 1, `${voxels.length} voxels`);
  assert.equal(shots[0].pairs.length, 28 * voxels.length);
  assert.equal(shots[0].drawn, 0, "springs that faces cover are drawn");
  assert.equal(shots[0].faces, counts[0].faces);
  await closed(tab);
});

test("a network has no skin to switch on", async () => {
  const tab = await opened(reported(ran("network", ["experiment.verify=0"]), "--best", "1"));
  assert.equal(await skinBox(tab).isVisible(), false);
  await tab.keyboard.press("s");
  assert.equal(await inPage(tab, ({ viewer }) => viewer.stages[0].hasSkin), false);
  await closed(tab);
});
