// Builds the page from the data that it contains.
import "uplot/dist/uPlot.min.css";
import "./style.css";
import { Charts } from "./charts.js";
import { element, short } from "./elements.js";
import { Gallery } from "./gallery.js";
import { readPalette } from "./colours.js";
import { Viewer } from "./viewer.js";

const data = JSON.parse(document.getElementById("data").textContent);
const { runs } = data;
const isGallery = data.kind === "gallery";
runs.forEach((run) => (run.label = run.folder ? `${run.folder.split("/").filter(Boolean).at(-1)}` : run.experiment));

const objectiveOf = (run, robot) => {
  const value = robot.objectives?.[run.objectives?.[0].name];
  return value === undefined ? robot.status : `${short(value)} ${run.objectives[0].unit}`;
};
const labelOf = (run, robot) => {
  const whose = runs.length > 1 ? `${run.label}: ` : "";
  return isGallery
    ? `Robot ${robot.individual}`
    : `${whose}${robot.role}, individual ${robot.individual}, ${objectiveOf(run, robot)}`;
};
const robots = runs.flatMap((run) => run.robots.map((robot) => ({ run, robot, label: labelOf(run, robot) })));

/** Formats a share in percent, which is shown as 100 only if it is exactly 100. */
const share = (part, all) => (part === all ? "100" : Math.min(99.9, (100 * part) / all).toFixed(1));

function facts(run) {
  const fact = (label, value, note) =>
    element(
      "div",
      { className: "fact" },
      element("dt", { textContent: label }),
      element("dd", {}, element("b", { textContent: value }), note ? element("span", { textContent: note }) : null),
    );
  const [objective] = run.objectives;
  const all = Object.values(run.statuses).reduce((sum, n) => sum + n, 0);
  const springs = run.generations.reduce((sum, g) => sum + g.spring_evaluations, 0);
  const marks = run.best?.verification?.marks;
  return element(
    "dl",
    { className: "facts" },
    runs.length > 1 ? fact("Run", run.label, `${run.experiment}, seed ${run.seed}`) : null,
    fact(`Best ${objective.name}`, short(run.best?.objectives[objective.name]), objective.unit),
    fact(
      "Evaluations",
      run.evaluations.toLocaleString("en"),
      run.finished
        ? `in ${run.generations.length} generation${run.generations.length === 1 ? "" : "s"}`
        : `of ${run.evaluations_asked.toLocaleString("en")}, not finished`,
    ),
    fact("Springs simulated", short(springs), "spring evaluations"),
    fact(
      "Ended well",
      all > 0 ? `${share(run.statuses.ok, all)} %` : "–",
      `${run.statuses.invalid} invalid, ${run.statuses.diverged} diverged`,
    ),
    fact(
      "The best, verified",
      marks === undefined ? "not yet" : marks.length > 0 ? marks.join(", ") : "held",
      marks === undefined ? "see evodevo verify" : marks.length > 0 ? "" : "neither artefact nor passive",
    ),
  );
}

function header() {
  const run = runs[0];
  const title = runs.length > 1 ? `${runs.length} runs` : run.experiment;
  const devices = (r) => [...new Set(r.provenances.map((m) => m.device))].join(", then ");
  const subtitle = isGallery
    ? `${robots.length} random robots of its encoding, seed ${run.seed}`
    : runs.length > 1
      ? runs.map((r) => r.label).join(" · ")
      : `${run.label} · seed ${run.seed} · ${devices(run)} · begun ${run.created.replace("T", " ").replace("Z", " UTC")}`;
  document.title = `${title} – evodevo`;
  return element("header", {}, element("h1", { textContent: title }), element("p", { textContent: subtitle }));
}

function robotTable(viewer) {
  const [{ objectives }] = runs;
  const names = objectives.map((o) => o.name);
  const cell = (text) => element("td", { textContent: text });
  const rows = robots.map(({ run, robot }, i) =>
    element(
      "tr",
      {},
      element(
        "td",
        {},
        element("button", {
          type: "button",
          textContent: robot.role,
          onclick: () => (viewer.show(i), viewer.root.scrollIntoView({ behavior: "smooth" })),
        }),
      ),
      ...(runs.length > 1 ? [cell(run.label)] : []),
      cell(String(robot.individual)),
      ...names.map((name, k) =>
        cell(name in robot.objectives ? `${short(robot.objectives[name])}${again(robot, name, k)}` : robot.status),
      ),
      cell(String(robot.generation)),
      cell(String(robot.age)),
      cell(robot.made_by),
      cell(robot.ancestry.length > 0 ? robot.ancestry.join(" ‹ ") : "none"),
    ),
  );
  const heads = [
    "",
    ...(runs.length > 1 ? ["Run"] : []),
    "Individual",
    ...objectives.map((o) => `${o.name} (${o.unit})`),
    "Born",
    "Age",
    "Made by",
    "First parents",
  ];
  return element(
    "section",
    { className: "table" },
    element("h2", { textContent: "Robots shown" }),
    element(
      "div",
      { className: "scroll" },
      element(
        "table",
        {},
        element("thead", {}, element("tr", {}, ...heads.map((text) => element("th", { textContent: text })))),
        element("tbody", {}, ...rows),
      ),
    ),
  );
}

/** Returns a note if the fitness in the life shown differs from that in the archive by more than 1 %, for example
 *  because it was simulated on another device. */
function again(robot, name, k) {
  const shown = robot.again[k];
  return shown === undefined || Math.abs(shown - robot.objectives[name]) <= 0.01 * Math.abs(robot.objectives[name])
    ? ""
    : ` (as shown: ${short(shown)})`;
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

async function begin() {
  readPalette();
  document.body.classList.toggle("film", location.hash === "#film");
  const main = element("main");
  document.body.append(main);
  main.append(header());
  if (!isGallery) main.append(...runs.map(facts));
  const page = { data, film: location.hash === "#film" };
  if (robots.length > 0) {
    page.viewer = new Viewer(robots);
    main.append(page.viewer.root);
    const first = robots.findIndex(({ robot }) => robot.film.shots.length > 0);
    await page.viewer.show(Math.max(0, first));
  }
  if (isGallery) {
    page.gallery = new Gallery(robots, page.viewer);
    main.append(page.gallery.root);
    await page.gallery.draw();
  } else {
    page.charts = new Charts(runs);
    main.append(page.charts.root);
    page.charts.draw();
    if (page.viewer) main.append(robotTable(page.viewer));
  }
  main.append(experiments(), element("footer", { textContent: `evodevo ${data.evodevo}` }));
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
    readPalette();
    page.viewer?.readTheme();
    page.gallery?.draw();
    page.charts?.draw();
  });
  return page;
}

// film.mjs and tests wait for this promise
window.evodevo = begin();
