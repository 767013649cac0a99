// The charts of a report.
import uPlot from "uplot";
import { element, short, style } from "./elements.js";

const height = 250;
const nothing = "Nothing to show: no individual has ended with a fitness.";

/** Returns the Pareto front of low age and good fitness, sorted by age. */
export function paretoFront(population, maximise) {
  const better = (a, b) => (maximise ? a > b : a < b);
  const sorted = [...population].sort((a, b) => a.age - b.age || (better(a.values[0], b.values[0]) ? -1 : 1));
  const front = [];
  for (const one of sorted) if (front.length === 0 || better(one.values[0], front.at(-1).values[0])) front.push(one);
  return front;
}

/** Merges series with different x values into columns over a common list of x values; null where a series has no
*  value. */
function joined(series) {
  const xs = [...new Set(series.flatMap(({ x }) => x))].sort((a, b) => a - b);
  const columns = series.map(({ x, y }) => {
    const at = new Map(x.map((value, i) => [value, y[i]]));
    return xs.map((value) => at.get(value) ?? null);
  });
  return [xs, ...columns];
}

/** Formats a value in the legend, which shows values only while the mouse is over the chart. */
const shown = (_, value, series, index) => (index === null ? "" : short(value));
const counts = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1e3, 2e3, 5e3, 1e4, 2e4, 5e4, 1e5, 2e5, 5e5, 1e6]; // steps of ticks

const line = (name, stroke, dash) => ({
  label: name,
  stroke,
  width: 2,
  dash,
  spanGaps: true,
  points: { show: false },
  value: shown,
});
const runColour = (index) => style("--series").split(/\s+/)[index % style("--series").split(/\s+/).length];
const runName = (run, runs) => (runs.length > 1 ? `${run.label} ` : "");

/** A figure with a chart that fills its width. `describe` returns the data, the series, the names of the axes and
*  options. */
class Chart {
  constructor(name, title, describe) {
    this.name = name;
    this.describe = describe;
    this.box = element("div", { className: "plot" });
    this.root = element("figure", {}, element("figcaption", { textContent: title }), this.box);
    new ResizeObserver(() => this.plot?.setSize({ width: this.box.clientWidth, height })).observe(this.box);
  }

  draw() {
    this.plot?.destroy();
    this.plot = undefined;
    const { data, series, x, y, wholeX, options } = this.describe();
    this.data = data;
    const isEmpty = data.slice(1).every((column) => column.every((value) => value === null));
    this.box.replaceChildren(...(isEmpty ? [element("p", { className: "note", textContent: nothing })] : []));
    if (isEmpty) return;
    const axis = (label, size) => ({
      label,
      size,
      stroke: style("--soft"),
      grid: { stroke: style("--rule"), width: 1 },
      ticks: { show: false },
      font: "12px system-ui",
      labelFont: "12px system-ui",
      labelSize: 18,
      values: (_, ticks) => ticks.map(short),
    });
    this.plot = new uPlot(
      {
        width: this.box.clientWidth || 400,
        height,
        scales: { x: { time: false } },
        axes: [{ ...axis(x, 36), ...(wholeX ? { incrs: counts } : {}) }, axis(y, 52)],
        legend: { live: true },
        cursor: { drag: { x: true, y: false } },
        ...options,
        series: [{ label: x, value: shown }, ...series],
      },
      data,
      this.box,
    );
  }
}

function progress(runs, name, title, x, xOf) {
  return new Chart(name, title, () => {
    const all = runs.flatMap((run, index) => {
      const xs = xOf(run.generations);
      const of = (key) => ({ x: xs, y: run.generations.map((g) => g[key]) });
      const colours = runs.length > 1 ? [runColour(index), runColour(index)] : [runColour(0), runColour(1)];
      return [
        [of("best"), line(`${runName(run, runs)}best`, colours[0])],
        [of("median"), line(`${runName(run, runs)}median`, colours[1], runs.length > 1 ? [5, 4] : undefined)],
      ];
    });
    return {
      data: joined(all.map(([values]) => values)),
      series: all.map(([, series]) => series),
      x,
      y: objectiveText(runs),
    };
  });
}

const objectiveText = (runs) =>
  [...new Set(runs.map(({ objectives: [first] }) => `${first.name} (${first.unit})`))].join(", ");

function cumulative(numbers) {
  let sum = 0;
  return numbers.map((number) => (sum += number));
}

function agesAndFitness(runs) {
  return new Chart("ages", "Age and fitness of the living, and the front of the best", () => {
    const all = runs.flatMap((run, index) => {
      const front = paretoFront(run.population, run.objectives[0].maximise);
      const dots = {
        stroke: undefined,
        fill: runColour(index),
        points: { show: true, size: 7, fill: runColour(index), stroke: "transparent" },
        paths: () => null,
      };
      // A chart has one value for each x, but several individuals can have the same age. Such individuals are moved
      // apart by an invisible distance.
      const seen = new Map();
      const x = run.population.map(({ age }) => {
        const times = seen.get(age) ?? 0;
        seen.set(age, times + 1);
        return age + times * 1e-7;
      });
      return [
        [
          { x, y: run.population.map(({ values }) => values[0]) },
          { label: `${runName(run, runs)}individual`, value: shown, ...dots },
        ],
        [
          { x: front.map(({ age }) => age + 1e-8), y: front.map(({ values }) => values[0]) },
          { ...line(`${runName(run, runs)}front`, runColour(index)), paths: uPlot.paths.stepped({ align: 1 }) },
        ],
      ];
    });
    return {
      data: joined(all.map(([values]) => values)),
      series: all.map(([, series]) => series),
      x: "age (generations)",
      wholeX: true,
      y: objectiveText(runs),
    };
  });
}

/** The status of the evaluations of each generation, as stacked shares. */
function statuses(run, title) {
  return new Chart("statuses", title, () => {
    const of = run.generations;
    const count = of.map((g, i) => g.evaluations - (i > 0 ? of[i - 1].evaluations : 0));
    const share = (bad) => of.map((g, i) => (100 * bad(g)) / count[i]);
    const area = (label, name, number) => ({
      label,
      stroke: style(name),
      fill: style(name),
      width: 1,
      points: { show: false },
      value: (_, v, k, i) => (i === null ? "" : number(of[i], count[i])),
    });
    return {
      data: [
        of.map((g) => g.generation),
        share(() => 0).map(() => 100),
        share((g) => g.invalid + g.diverged),
        share((g) => g.diverged),
      ],
      series: [
        area("ok", "--good", (g, all) => all - g.invalid - g.diverged),
        area("invalid", "--warn", (g) => g.invalid),
        area("diverged", "--bad", (g) => g.diverged),
      ],
      x: "generation",
      wholeX: true,
      y: "% of evaluations",
      options: { scales: { x: { time: false }, y: { range: [0, 100] } } },
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
    ? ["simulate", "develop", "decode", "archive"].map((phase) => row(phase, run.time[phase]))
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
  constructor(runs) {
    const titleOf = (title, run) => (runs.length > 1 ? `${title}: ${run.label}` : title);
    const shared = [
      progress(runs, "evaluations", "Fitness over evaluations", "evaluations", (g) => g.map((s) => s.evaluations)),
      progress(runs, "springs", "Fitness over springs simulated", "spring evaluations", (g) =>
        cumulative(g.map((s) => s.spring_evaluations)),
      ),
      agesAndFitness(runs),
    ];
    const ends = runs.map((run) => statuses(run, titleOf("How evaluations ended", run)));
    this.list = [...shared, ...ends];
    this.byName = Object.fromEntries(this.list.map((chart) => [chart.name, chart]));
    this.root = element(
      "section",
      { className: "charts" },
      ...shared.map((chart) => chart.root),
      ...runs.flatMap((run, i) => [ends[i].root, timeSpent(run, titleOf("Where the time went", run))]),
    );
  }

  draw() {
    this.list.forEach((chart) => chart.draw());
  }
}
