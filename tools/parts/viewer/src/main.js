// Builds the page from the data that it contains.
import "uplot/dist/uPlot.min.css";
import "./style.css";
import { Champions } from "./champions.js";
import { Charts } from "./charts.js";
import { readPalette } from "./colours.js";
import { element, prefersStill, short } from "./elements.js";
import { Gallery } from "./gallery.js";
import { migrantTables } from "./islands.js";
import { Lineage } from "./lineage.js";
import { NicheMaps } from "./niches.js";
import { directionOf, hasUnit, inLifeShown, listed, own, quantityText } from "./scores.js";
import { linked, shellWord } from "./share.js";
import { signalTables } from "./signal.js";
import { stillOf } from "./still.js";
import { colourRuns, factTable, robotTable, TestTable, VerificationTable } from "./tables.js";
import { hasGraphics, Viewer } from "./viewer.js";

const data = JSON.parse(document.getElementById("data").textContent);
const { runs } = data;
const isGallery = data.kind === "gallery";
runs.forEach((run) => (run.label = run.folder ? `${run.folder.split("/").filter(Boolean).at(-1)}` : run.experiment));

/** Returns the objectives of a robot in the life shown with their units and, if there are several, their names; otherwise
 *  its status. */
const scoreText = (run, robot) => {
  const scores = inLifeShown(robot);
  const known = (run.objectives ?? []).filter(({ name }) => own(scores, name) !== undefined);
  const named = (objective) => (known.length > 1 ? `${objective.name} ` : "");
  const texts = known.map((objective) => named(objective) + quantityText(scores[objective.name], objective));
  return texts.length > 0 ? texts.join(", ") : robot.status;
};
const nameOf = (run, robot) => {
  const whose = runs.length > 1 ? `${run.label}: ` : "";
  const life = robot.lived > 1 ? `, life ${robot.life}` : "";
  return isGallery ? `Robot ${robot.individual}` : `${whose}${robot.role}, individual ${robot.individual}${life}`;
};
const isElite = ({ robot }) => robot.role === "elite";
/** Whether this is the first life of a robot that the page shows. */
const isFirstLife = ({ run, robot }) => run.robots.find(({ individual }) => individual === robot.individual) === robot;
const robots = runs
  .flatMap((run) =>
    run.robots.map((robot) => {
      const name = nameOf(run, robot);
      return { run, robot, name, label: isGallery ? name : `${name}, ${scoreText(run, robot)}` };
    }),
  )
  .sort((a, b) => isElite(a) - isElite(b)); // the many elites of all runs come last

/** Formats a share in percent, which is shown as 100 only if it is exactly 100. */
const share = (part, all) => (part === all ? "100" : Math.min(99.9, (100 * part) / all).toFixed(1));

const fact = (label, value, note = "") => ({ label, value, note });

function coverageFact({ map, generations }) {
  const score = generations.at(-1)?.map?.qd_score ?? null;
  const filled = `${map.elites.length.toLocaleString("en")} of ${map.cells.toLocaleString("en")}`;
  return fact("Coverage", filled, listed("cells", score === null ? "" : `QD score ${short(score)}`));
}

/** The top speed that friction allows against damping, and how near the best robot came to it. */
function topSpeedFact({ length, speed, limit }) {
  if (limit === null) return fact("Top speed", "no limit", `without damping; the best moved at ${short(speed)} m/s`);
  if (limit <= 0) return fact("Top speed", "0 m/s", "friction does not hold the robots on this slope");
  const lengths = length > 0 ? `, or ${short(limit / length)} lengths/s` : "";
  const reached = `; the best reached ${Math.round((100 * speed) / limit)} %`;
  return fact("Top speed", `${short(limit)} m/s`, `is all that friction allows${lengths}${reached}`);
}

/** Returns the facts of a run, each as {label, value, note}. */
function factsOf(run) {
  const all = Object.values(run.statuses).reduce((sum, n) => sum + n, 0);
  const springs = run.generations.reduce((sum, g) => sum + g.spring_evaluations, 0);
  const marks = run.best?.verification?.marks;
  return [
    ...run.objectives.map((o) =>
      fact(`Best ${o.name}`, short(o.best?.value), listed(hasUnit(o.unit) ? o.unit : "", directionOf(o))),
    ),
    fact(
      "Evaluations",
      run.evaluations.toLocaleString("en"),
      run.finished
        ? `in ${run.generations.length} generation${run.generations.length === 1 ? "" : "s"}`
        : `of ${run.evaluations_asked.toLocaleString("en")}, not finished`,
    ),
    ...(run.map ? [coverageFact(run)] : []),
    ...(run.top_speed ? [topSpeedFact(run.top_speed)] : []),
    fact("Springs simulated", short(springs), "spring evaluations"),
    fact(
      "Ended well",
      all > 0 ? `${share(run.statuses.ok, all)} %` : "–",
      ["invalid", "diverged", "artefact", "lucky", "passive"]
        .filter((status, i) => i < 2 || run.statuses[status] > 0)
        .map((status) => `${run.statuses[status]} ${status}`)
        .join(", "),
    ),
    fact(
      "The best, verified",
      marks === undefined ? "not yet" : marks.length > 0 ? marks.join(", ") : "held",
      run.best?.verification?.verdict ?? "see evodevo verify",
    ),
  ];
}

/** The facts of a run as tiles, or those of several runs as a table with a column for each. */
function facts() {
  if (runs.length > 1) return factTable(runs, runs.map(factsOf));
  const tile = ({ label, value, note }) =>
    element(
      "div",
      { className: "fact" },
      element("dt", { textContent: label }),
      element("dd", {}, element("b", { textContent: value }), note ? element("span", { textContent: note }) : null),
    );
  return element("dl", { className: "facts" }, ...factsOf(runs[0]).map(tile));
}

function header() {
  const run = runs[0];
  const title = runs.length > 1 ? `${runs.length} runs` : run.experiment;
  const devices = (r) => [...new Set(r.provenances.filter((p) => p.evaluations > 0).map((p) => p.device))].join(", ");
  const subtitle = isGallery
    ? `${robots.length} random robots of its encoding, seed ${run.seed}`
    : runs.length > 1
      ? runs.map((r) => r.label).join(" · ")
      : `${run.label} · seed ${run.seed} · ${devices(run)} · begun ${run.created.replace("T", " ").replace("Z", " UTC")}`;
  document.title = `${title} – evodevo`;
  return element("header", {}, element("h1", { textContent: title }), element("p", { textContent: subtitle }));
}

const experiments = () =>
  element(
    "section",
    { className: "experiment" },
    ...runs.map((run) =>
      element(
        "details",
        {},
        element("summary", {
          textContent: runs.length > 1 ? `Experiment of ${run.label}` : "The experiment, every default written out",
        }),
        element("pre", { textContent: run.resolved }),
      ),
    ),
  );

/** The figures with pictures of robots: the champions and the ancestors of each run. */
function portraits(viewer) {
  const titled = (title, run) => (runs.length > 1 ? `${title}: ${run.label}` : title);
  const open = (run) => (individual) => openIndividual({ run, individual }, viewer);
  const figures = (isThere, Figure, title) =>
    runs.filter(isThere).map((run) => new Figure(run, titled(title, run), robots.filter(isFirstLife), open(run)));
  return [
    ...figures(({ champions }) => champions.count > 0, Champions, "The best robot over the generations"),
    ...figures(({ lineage }) => lineage.length > 0, Lineage, "Where the robots come from"),
  ];
}

/** Shows what the address asks for, or the first robot that has lived, which then plays unless the reader prefers still
 *  pages. */
async function showFirst(viewer, isFilm) {
  const link = linked(location.hash, robots);
  if (link) return viewer.restore(link);
  const first = robots.findIndex(({ robot }) => robot.film.shots.length > 0);
  await viewer.show(Math.max(0, first));
  const isStill = isFilm || isGallery || prefersStill();
  if (!isStill && first >= 0) viewer.toggle();
}

/** Shows an individual, if the page has its film. */
function openIndividual({ run, individual }, viewer) {
  const index = robots.findIndex((one) => one.run === run && one.robot.individual === individual);
  notice.hidden = index >= 0;
  if (index >= 0) return viewer?.open(index);
  const command = `evodevo report ${shellWord(run.folder)} --individual ${individual}`;
  notice.textContent = `The page does not hold individual ${individual}. To see it: ${command}`;
}

const notice = element("p", { className: "notice", role: "status", hidden: true });

async function begin() {
  readPalette();
  document.body.classList.toggle("film", location.hash === "#film");
  const main = element("main");
  document.body.append(main);
  main.append(header());
  if (!isGallery) main.append(facts());
  const page = { data, film: location.hash === "#film" };
  if (robots.length > 0 && hasGraphics()) page.viewer = new Viewer(robots);
  page.niches = new NicheMaps(runs, robots, page.viewer);
  if (page.viewer) {
    const tests = [new TestTable(robots), new VerificationTable(robots)];
    page.viewer.onshow = (shown) => {
      tests.forEach((table) => table.show(shown));
      page.niches.show(shown);
    };
    main.append(page.viewer.root, ...tests.map(({ root }) => root));
    await showFirst(page.viewer, page.film);
  } else if (robots.length > 0) main.append(await stillOf(robots[0]));
  if (isGallery && page.viewer) {
    page.gallery = new Gallery(robots, page.viewer);
    main.append(page.gallery.root);
    await page.gallery.draw();
  } else if (!isGallery) {
    page.charts = new Charts(runs, (point) => openIndividual(point, page.viewer));
    main.append(page.charts.root);
    page.charts.root.prepend(...page.niches.figures);
    page.charts.root.after(notice);
    page.charts.draw();
    page.portraits = portraits(page.viewer);
    page.pictured = Promise.all(page.portraits.map((one) => one.draw())); // pictures may come later than the page
    main.append(
      ...page.portraits.map(({ root }) => root),
      ...signalTables(runs),
      robotTable(runs, robots, isFirstLife, page.viewer),
      ...migrantTables(runs),
    );
  }
  main.append(experiments(), element("footer", { textContent: `evodevo ${data.evodevo}` }));
  addEventListener("hashchange", () => {
    const link = linked(location.hash, robots);
    if (link) page.viewer?.restore(link);
  });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
    readPalette();
    colourRuns(document);
    page.viewer?.readTheme();
    page.gallery?.draw();
    page.charts?.draw();
    page.portraits?.forEach((one) => one.draw());
  });
  return page;
}

// film.mjs and tests wait for this promise
window.evodevo = begin();
