// The charts of a report.
import { Chart, joined, line, shown, stepped } from "./chart.js";
import { faded, runColour } from "./colours.js";
import { element, short, style } from "./elements.js";
import {
  age,
  directionOf,
  listed,
  measuresOf,
  notesOf,
  objectivesOf,
  own,
  titled,
} from "./scores.js";

/** Returns the Pareto front of points {x, y}, sorted by x. High values are good where a direction is 1, and low ones
*  where it is -1. */
function paretoFront(points, xBetter, yBetter) {
  const sorted = [...points].sort((a, b) => xBetter * (b.x - a.x) || yBetter * (b.y - a.y));
  const front = [];
  for (const one of sorted) if (front.length === 0 || yBetter * (one.y - front.at(-1).y) > 0) front.push(one);
  return front.sort((a, b) => a.x - b.x);
}

/** Returns points sorted by x. A chart has one value for each x, but several points can have the same x. Such points are
*  moved apart by an invisible distance. */
function apart(points) {
  const sorted = points.map((point) => ({ ...point })).sort((a, b) => a.x - b.x);
  const [low, high] = [sorted[0]?.x ?? 0, sorted.at(-1)?.x ?? 0];
  const step = Math.max(1e-9 * (high - low), 4 * Number.EPSILON * Math.max(-low, high)) || 1e-9;
  for (let i = 1; i < sorted.length; ++i) sorted[i].x = Math.max(sorted[i].x, sorted[i - 1].x + step);
  return sorted;
}

const runName = (run, runs) => (runs.length > 1 ? `${run.label} ` : "");

/** Returns the data and series of two numbers over the generations of each run. of() returns the object of a generation
 *  that holds the numbers by their `names`, or undefined. */
function twoNumbers(runs, names, xOf, of) {
  const all = runs.flatMap((run, index) => {
    const column = (key) => ({ x: xOf(run.generations), y: run.generations.map((g) => of(g)?.[key] ?? null) });
    const several = runs.length > 1;
    return names.map((name, k) => [
      column(name),
      stepped(line(runName(run, runs) + name, runColour(several ? index : k), several && k > 0 ? [5, 4] : undefined)),
    ]);
  });
  return { data: joined(all.map(([values]) => values)), series: all.map(([, series]) => series) };
}

function progress(runs, name, title, x, xOf) {
  const objectives = objectivesOf(runs);
  const describe = (objective) => ({
    ...twoNumbers(runs, ["best", "median"], xOf, (g) => own(g.objectives, objective.name)),
    x,
    y: axisText(objective),
  });
  return new Chart(name, title, describe, [{ label: "Objective", scores: objectives, first: objectives[0] }]);
}

/** Coverage of the map of niches and, where it has one, its QD score; nothing if no run has a map. */
function niches(runs) {
  const mapped = runs.filter((run) => run.map);
  if (mapped.length === 0) return [];
  const unitOf = (run) => run.objectives.find(({ name }) => name === run.map.objective).unit;
  const isScored = (run) => run.generations.some((g) => (g.map?.qd_score ?? null) !== null);
  const units = [...new Set(mapped.filter(isScored).map(unitOf))];
  const coverage = { name: "coverage", unit: "%", of: (_, map) => 100 * map.coverage };
  const scoreIn = (unit) => ({ name: "QD score", unit, of: (run, map) => (unitOf(run) === unit ? map.qd_score : null) });
  const choice = { label: "y axis", scores: [coverage, ...units.map(scoreIn)], first: coverage };
  const describe = (score) => ({
    data: joined(
      mapped.map(({ generations, ...run }) => ({
        x: generations.map((g) => g.evaluations),
        y: generations.map((g) => (g.map ? score.of(run, g.map) : null)),
      })),
    ),
    series: mapped.map((run) => stepped(line(`${runName(run, runs)}${score.name}`, runColour(runs.indexOf(run))))),
    x: "evaluations",
    y: titled(score),
  });
  const title = `Coverage${units.length > 0 ? " and QD score" : ""} over evaluations`;
  return [new Chart("niches", title, describe, [choice])];
}

const numbersOf = (generations) => generations.map((g) => g.generation);

/** Returns a text that begins with a capital letter. */
const capitalised = (text) => text.charAt(0).toUpperCase() + text.slice(1);

/** The greatest and the median of each quantity that selection notes about the living. */
function notedQuantities(runs) {
  const isThere = ({ name }) => runs.some((run) => run.generations.some((g) => own(g.notes, name)));
  const describe = (note) => () => ({
    ...twoNumbers(runs, ["greatest", "median"], numbersOf, (g) => own(g.notes, note.name)),
    x: "generation",
    wholeX: true,
    y: titled(note),
  });
  return notesOf(runs)
    .filter((note) => !note.is_label && isThere(note))
    .map((note) => new Chart(`note ${note.name}`, `${capitalised(note.name)} over generations`, describe(note)));
}

/** The sizes of the groups that a note of selection divides the living of a run into, stacked. */
function groups(run, { name, groups: listedGroups, others }, title) {
  return new Chart(`groups ${name}`, title, () => {
    const all = listedGroups.map(({ label, counts }, i) => ({
      text: `${name} ${label}`,
      counts,
      colour: groupColour(i),
    }));
    if (others.some((count) => count > 0)) all.push({ text: "others", counts: others, colour: style("--rule") });
    const tops = run.generations.map(() => 0);
    const stacked = all.map(({ text, counts, colour }) => ({
      data: counts.map((count, i) => (tops[i] += count)),
      series: {
        label: text,
        stroke: style("--paper"),
        fill: colour,
        width: 0.5,
        points: { show: false },
        value: (_, v, k, i) => (i === null ? "" : short(counts[i])),
      },
    }));
    const names = all.map(({ text }) => text);
    const generations = numbersOf(run.generations);
    stacked.reverse(); // a lower area is drawn over a higher one
    return {
      data: [generations, ...stacked.map(({ data }) => data)],
      rows: [["generation", ...names], ...generations.map((g, i) => [g, ...all.map(({ counts }) => counts[i])])],
      series: stacked.map(({ series }) => series),
      x: "generation",
      wholeX: true,
      y: "individuals",
      options: { scales: { y: { range: [0, Math.max(...tops)] } } },
    };
  });
}

/** The colour of the i-th group: those of runs, then the same ones paler. */
function groupColour(i) {
  const count = style("--series").split(/\s+/).length;
  return i % (2 * count) < count ? runColour(i) : faded(runColour(i));
}

/** Returns the name of an axis. */
const axisText = (score) => listed(titled(score), directionOf(score));

function cumulative(numbers) {
  let sum = 0;
  return numbers.map((number) => (sum += number));
}

/** The living as points, with a choice of what the axes show. There is a front where both axes say what is better. */
function living(runs, open) {
  const objectives = objectivesOf(runs);
  const scores = [...objectives, ...measuresOf(runs)];
  const all = [age, ...scores];
  const describe = (x, y) => {
    const columns = runs.flatMap((run, index) => livingOf(run, x, y, runColour(index), runName(run, runs)));
    return {
      title: scores.length > 1 ? `The living${hasFront(x, y) ? ", and the front of the best" : ""}` : undefined,
      data: joined(columns.map(([values]) => values)),
      points: columns.flatMap(([{ x: xs, y: ys, who }]) =>
        (who ?? []).map((one, i) => ({ x: xs[i], y: ys[i], open: () => open(one) })),
      ),
      series: columns.map(([, series]) => series),
      x: axisText(x),
      wholeX: x === age,
      options: { scales: { x: { range: padded } } },
      y: axisText(y),
    };
  };
  const choices = [
    { label: "x axis", scores: scores.length > 1 ? all : [age], first: age },
    { label: "y axis", scores: scores.length > 1 ? all : scores, first: objectives[0] },
  ];
  return new Chart("ages", "Age and fitness of the living, and the front of the best", describe, choices);
}

/** The range of an axis with room for the points at its ends. */
const padded = (_, low, high) => {
  const pad = 0.03 * (high - low) || 0.5;
  return [low - pad, high + pad];
};

const hasFront = (x, y) => x.better !== 0 && y.better !== 0;

/** Returns the columns and series of one run: its individuals, and their front if there is one. */
function livingOf(run, x, y, colour, name) {
  const points = run.population
    .map((individual) => ({ x: x.of(individual), y: y.of(individual), who: { run, individual: individual.id } }))
    .filter((point) => Number.isFinite(point.x) && Number.isFinite(point.y));
  const column = (list) => ({ x: list.map((point) => point.x), y: list.map((point) => point.y) });
  const dots = {
    label: `${name}individual`,
    value: shown,
    fill: colour,
    points: { show: true, size: 7, fill: colour, stroke: "transparent" },
    paths: () => null,
    dots: true,
  };
  const separate = apart(points);
  const individuals = [{ ...column(separate), who: separate.map(({ who }) => who) }, dots];
  if (!hasFront(x, y)) return [individuals];
  const front = paretoFront(points, x.better, y.better);
  return [individuals, [column(front), stepped(line(`${name}front`, colour), x.better < 0 ? 1 : -1)]];
}

/** The statuses without a fitness, from the bottom of the chart to its top; the last three only if the run has any. */
const lostStatuses = (run) =>
  [
    ["invalid", "--warn"],
    ["diverged", "--bad"],
    ["artefact", "--accent"],
    ["lucky", "--born"],
    ["passive", "--soft"],
  ].filter(([name], i) => i < 2 || run.statuses[name] > 0);

/** The status of the evaluations of each generation, as stacked shares. */
function statuses(run, title) {
  return new Chart("statuses", title, () => {
    const of = run.generations;
    const count = of.map((g, i) => g.evaluations - (i > 0 ? of[i - 1].evaluations : 0));
    const lost = lostStatuses(run);
    const lostFrom = (first) => (g) => lost.slice(first).reduce((sum, [name]) => sum + g[name], 0);
    const share = (bad) => of.map((g, i) => (100 * bad(g)) / count[i]);
    const area = ({ label, colour, counts }) => ({
      label,
      stroke: style(colour),
      fill: style(colour),
      width: 1,
      points: { show: false },
      value: (_, v, k, i) => (i === null ? "" : counts[i]),
    });
    const ok = of.map((g, i) => Math.max(0, count[i] - lostFrom(0)(g))); // the lost may be older individuals
    const all = [
      { label: "ok", colour: "--good", counts: ok },
      ...lost.map(([name, colour]) => ({ label: name, colour, counts: of.map((g) => g[name]) })),
    ];
    return {
      data: [
        of.map((g) => g.generation),
        share(() => 0).map(() => 100),
        ...lost.map((_, i) => share(lostFrom(i))),
      ],
      rows: [
        ["generation", ...all.map(({ label }) => label)],
        ...of.map((g, i) => [g.generation, ...all.map(({ counts }) => counts[i])]),
      ],
      series: all.map(area),
      x: "generation",
      wholeX: true,
      y: "% of evaluations",
      options: { scales: { y: { range: [0, 100] } } },
    };
  });
}

/** Bars that show the time of each phase. Phases overlap, so their sum may exceed the total time. */
function timeSpent(run, title) {
  const whole = run.time?.whole ?? run.generations.reduce((sum, g) => sum + g.wall_time, 0);
  const row = (name, seconds) =>
    element(
      "div",
      { className: "bar" },
      element("span", { textContent: name }),
      element("i", {}, element("b", { style: `width:${Math.min(100, (100 * seconds) / whole)}%` })),
      element("span", { textContent: `${short(seconds)} s · ${Math.round((100 * seconds) / whole)} %` }),
    );
  const phases = run.time
    ? ["simulate", "develop", "decode", "archive", "verify"]
        .filter((phase) => phase !== "verify" || run.time[phase] > 0)
        .map((phase) => row(phase, run.time[phase]))
    : [];
  return element(
    "figure",
    {},
    element("figcaption", { textContent: title }),
    element("p", {
      className: "note",
      textContent: run.time
        ? `${short(whole)} s in all; phases overlap`
        : `${short(whole)} s in all; this run's record does not hold its phases`,
    }),
    ...phases,
  );
}

/** The charts of runs, as figures. draw() draws them; `byName` finds them by their names. */
export class Charts {
  /** `open` is called with {run, individual} when a point of a living individual is clicked. */
  constructor(runs, open) {
    const titleOf = (title, run) => (runs.length > 1 ? `${title}: ${run.label}` : title);
    const shared = [
      ...niches(runs),
      progress(runs, "evaluations", "Fitness over evaluations", "evaluations", (g) => g.map((s) => s.evaluations)),
      progress(runs, "springs", "Fitness over springs simulated", "spring evaluations", (g) =>
        cumulative(g.map((s) => s.spring_evaluations)),
      ),
      living(runs, open),
      ...notedQuantities(runs),
    ];
    const grouped = runs.flatMap((run) =>
      (run.labels ?? []).map((label) =>
        groups(run, label, titleOf(`${capitalised(label.name)} over generations`, run)),
      ),
    );
    const ends = runs.map((run) => statuses(run, titleOf("How evaluations ended", run)));
    this.list = [...shared, ...grouped, ...ends];
    this.byName = Object.fromEntries(this.list.map((chart) => [chart.name, chart]));
    this.root = element(
      "section",
      { className: "charts" },
      ...[...shared, ...grouped].map((chart) => chart.root),
      ...runs.flatMap((run, i) => [ends[i].root, timeSpent(run, titleOf("Where the time went", run))]),
    );
  }

  draw() {
    this.list.forEach((chart) => chart.draw());
  }
}
