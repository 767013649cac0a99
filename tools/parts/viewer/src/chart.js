// A chart: a figure that can be saved as SVG and CSV.
import uPlot from "uplot";
import { element, short, style } from "./elements.js";
import { scoreChooser } from "./scores.js";
import { csv, fileName, save } from "./share.js";
import { chartSvg } from "./svg.js";

const height = 250;
const reach = 12; // pixels from a point in which a click opens it
const nothing = "Nothing to show: no individual has ended with a fitness.";

/** Merges series with different x values into columns over a common list of x values; null where a series has no
*  value. */
export function joined(series) {
  const xs = [...new Set(series.flatMap(({ x }) => x))].sort((a, b) => a - b);
  const columns = series.map(({ x, y }) => {
    const at = new Map(x.map((value, i) => [value, y[i]]));
    return xs.map((value) => at.get(value) ?? null);
  });
  return [xs, ...columns];
}

/** Formats a value in the legend, which shows values only while the mouse is over the chart. */
export const shown = (_, value, series, index) => (index === null ? "" : short(value));
const counts = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1e3, 2e3, 5e3, 1e4, 2e4, 5e4, 1e5, 2e5, 5e5, 1e6]; // steps of ticks

/** Returns the texts of ticks, with as many digits as tell them apart. */
function tickTexts(ticks) {
  const texts = ticks.map(short);
  for (let digits = 5; new Set(texts).size < texts.length && digits <= 17; ++digits)
    ticks.forEach((tick, i) => (texts[i] = String(Number(tick.toPrecision(digits)))));
  return texts;
}

/** The least width of an axis, as a part of its larger bound. The ticks of a far narrower one would be equal after
 *  rounding, and uPlot would never come to the last. */
const narrowest = 1e-3;

/** Returns the range of a scale, which is wide enough for ticks. */
const wideEnough = (range) => (plot, least, most) => {
  const [low, high] = range(plot, least, most);
  const missing = (narrowest * Math.max(Math.abs(low), Math.abs(high)) || 1) - (high - low);
  return missing > 0 ? [low - missing / 2, high + missing / 2] : [low, high];
};
const ranges = {
  x: (_, low, high) => [low, high],
  y: (_, low, high) => (low === null ? [low, high] : uPlot.rangeNum(low, high, 0.1, true)),
};

/** Returns the scales x and y with the given options. */
const scalesWith = (given = {}) =>
  Object.fromEntries(
    Object.entries(ranges).map(([name, usual]) => {
      const { range = usual, ...others } = given[name] ?? {};
      return [name, { time: false, range: Array.isArray(range) ? range : wideEnough(range), ...others }];
    }),
  );

/** Returns a series with steps at the end of each interval (1), so that a value holds until the next, or at its
 *  beginning (-1). */
export const stepped = (series, steps = 1) => ({ ...series, steps, paths: uPlot.paths.stepped({ align: steps }) });

export const line = (name, stroke, dash) => ({
  label: name,
  stroke,
  width: 2,
  dash,
  spanGaps: true,
  points: { show: false },
  value: shown,
});

/** A figure with a chart that fills its width. `describe` returns the data, the series, the names of the axes, options
*  and, if they depend on the scores chosen, the title and the points that can be opened, {x, y, open}; and, if the data
*  are heights in a stack, the `rows` of the numbers behind them, below a row with their names. It is given one
*  score of each of the `choices`, {label, scores, first}, which the user can change if there are several scores. */
export class Chart {
  constructor(name, title, describe, choices = []) {
    this.name = name;
    this.chosen = choices.map(({ first }) => first);
    this.describe = () => describe(...this.chosen);
    this.title = title;
    this.caption = element("figcaption", { textContent: title });
    this.box = element("div", { className: "plot" });
    const choosers = choices.flatMap(({ label, scores, first }, i) =>
      scores.length > 1 ? [scoreChooser(label, scores, first, (score) => this.#choose(i, score))] : [],
    );
    this.root = element(
      "figure",
      {},
      this.caption,
      choosers.length > 0 ? element("div", { className: "choosers" }, ...choosers) : null,
      this.box,
      this.#saving(),
    );
    new ResizeObserver(() => this.plot?.setSize({ width: this.box.clientWidth, height })).observe(this.box);
  }

  /** Creates the buttons that save the chart as it is shown. */
  #saving() {
    const button = (ending, write) =>
      element("button", {
        type: "button",
        textContent: `Save ${ending.toUpperCase()}`,
        "aria-label": `Save ${ending.toUpperCase()}: ${this.title}`,
        onclick: () => save(fileName(this.caption.textContent, ending), write()),
      });
    this.saving = element(
      "div",
      { className: "save" },
      button("svg", () => chartSvg(this.plot, this.caption.textContent, this.data)),
      button("csv", () => csv(this.#rows())),
    );
    return this.saving;
  }

  /** Returns the chart's data as rows, the first of which has the names of the columns. */
  #rows() {
    if (this.rows) return this.rows;
    const names = this.plot.series.map(({ label }) => label);
    return [names, ...this.data[0].map((_, i) => this.data.map((column) => column[i]))];
  }

  #choose(i, score) {
    this.chosen[i] = score;
    this.draw();
  }

  draw() {
    this.plot?.destroy();
    this.plot = undefined;
    const { title, data, rows, series, x, y, wholeX, options: { scales, ...options } = {}, points } = this.describe();
    this.caption.textContent = title ?? this.title;
    this.data = data;
    this.rows = rows;
    const isEmpty = data.slice(1).every((column) => column.every((value) => value === null));
    this.box.replaceChildren(...(isEmpty ? [element("p", { className: "note", textContent: nothing })] : []));
    this.saving.hidden = isEmpty;
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
      values: (_, ticks) => tickTexts(ticks),
    });
    this.plot = new uPlot(
      {
        width: this.box.clientWidth || 400,
        height,
        scales: scalesWith(scales),
        axes: [{ ...axis(x, 36), ...(wholeX ? { incrs: counts } : {}) }, axis(y, 52)],
        legend: { live: true },
        cursor: { drag: { x: true, y: false } },
        ...options,
        series: [{ label: x, value: shown }, ...series],
      },
      data,
      this.box,
    );
    if (!points) return;
    this.plot.over.classList.add("pointed");
    this.plot.over.addEventListener("click", ({ offsetX, offsetY }) => {
      const near = points.map((point) => [this.#distance(point, offsetX, offsetY), point]);
      const [distance, point] = near.reduce((a, b) => (b[0] < a[0] ? b : a));
      if (distance <= reach) point.open();
    });
  }

  /** Returns how far a point of the chart is from a place on it, in pixels. */
  #distance({ x, y }, left, top) {
    return Math.hypot(this.plot.valToPos(x, "x") - left, this.plot.valToPos(y, "y") - top);
  }
}
