// The maps of niches: the best robot of each cell of the grid that the first two descriptors span.
import { colourBar, css, nicheColour } from "./colours.js";
import { element, short } from "./elements.js";
import { directionOf, listed, quantityText, titled } from "./scores.js";
import { shellWord } from "./share.js";

const intervals = 5; // at most, between the values written at an axis
const finest = 30; // bins along an axis that leave room for marks in the cells

/** Returns the value at a border of an axis's cells: 0 is the lower end, and the number of bins the upper one. */
const border = ({ low, high, bins }, k) => (low * (bins - k) + high * k) / bins;

/** Returns the borders whose values are written at an axis: at equal distances and, if possible, including both ends. */
function ticks({ bins }) {
  const least = Math.ceil(bins / intervals);
  const steps = Array.from({ length: least }, (_, i) => least + i);
  const step = steps.find((one) => bins % one === 0) ?? least;
  return Array.from({ length: Math.floor(bins / step) + 1 }, (_, i) => i * step);
}

/** Returns the range of values of a cell along an axis. Cells at an end also hold the values beyond it. */
function rangeText(axis, k) {
  const { name, bins } = axis;
  const at = (i) => quantityText(border(axis, i), axis);
  if (bins === 1) return `any ${name}`;
  if (k === 0) return `${name} below ${at(1)}`;
  if (k === bins - 1) return `${name} from ${at(k)} up`;
  return `${name} ${short(border(axis, k))} to ${at(k + 1)}`;
}

/** Returns the parts of an axis: its name, and values at the positions of borders. `side` is the edge that positions
 *  are measured from. */
function axisParts(axis, name, side) {
  const value = (k) =>
    element("span", { textContent: short(border(axis, k)), style: `${side}:${(100 * k) / axis.bins}%` });
  return [
    element("div", { className: `${name} values` }, ...ticks(axis).map(value)),
    element("div", { className: `${name} title`, textContent: titled(axis) }),
  ];
}

/** The map of one run. `range` holds the values of the first and the last colour. */
class NicheMap {
  constructor(run, title, objective, range, robots, viewer) {
    this.run = run;
    this.objective = objective;
    this.viewer = viewer;
    this.columns = run.map.axes[0].bins;
    this.rows = run.map.axes[1]?.bins ?? 1;
    const own = robots.map((one, index) => [one, index]).filter(([one]) => one.run === run);
    const indices = new Map(own.reverse().map(([one, index]) => [one.robot.individual, index])); // of their first lives
    this.cells = run.map.elites
      .map(({ cell: [column, row = 0], individual, value }) => ({
        column,
        row,
        individual,
        value,
        robot: indices.get(individual),
      }))
      .sort((a, b) => b.row - a.row || a.column - b.column); // as one reads: from top to bottom, from left to right
    this.cells.forEach((cell) => (cell.button = this.#button(cell, range)));
    this.at = new Map(this.cells.map((cell) => [this.#place(cell), cell]));
    this.info = element("p", { className: "note" });
    this.root = this.#figure(title, range);
    this.show([]);
    this.#explain();
  }

  #place({ column, row }) {
    return row * this.columns + column;
  }

  #button(cell, [low, high]) {
    const { column, row, value, robot } = cell;
    const percent = (part, all) => `${(100 * part) / all}%`;
    const place = `left:${percent(column, this.columns)};bottom:${percent(row, this.rows)}`;
    const size = `width:${percent(1, this.columns)};height:${percent(1, this.rows)}`;
    const colour = css(nicheColour(high > low ? (value - low) / (high - low) : 1));
    const properties = {
      type: "button",
      className: robot === undefined ? "niche" : "niche filmed",
      style: `${place};${size}`,
      "aria-label": this.#textOf(cell),
      onfocus: () => this.#focused(cell),
      onclick: () => this.#clicked(cell),
    };
    return element("button", properties, element("i", { style: `background:${colour}` }));
  }

  #figure(title, [low, high]) {
    const { axes } = this.run.map;
    const most = quantityText(high, this.objective);
    const swatch = (name, text) =>
      element("span", { className: "swatch" }, element("i", { className: name }), text);
    const isFine = Math.max(this.columns, this.rows) > finest;
    this.grid = element(
      "div",
      {
        className: "cells",
        role: "group",
        "aria-label": `${title}. The arrow keys go from robot to robot, and Enter shows one.`,
        onkeydown: (event) => this.#pressed(event),
        onpointermove: (event) => this.#pointed(event),
        onpointerleave: () => this.#explain(this.cells.find(({ button }) => button === document.activeElement)),
      },
      ...this.cells.map(({ button }) => button),
    );
    return element(
      "figure",
      { className: `niches ${axes.length > 1 ? "" : "single"} ${isFine ? "fine" : ""}` },
      element("figcaption", { textContent: title }),
      element(
        "div",
        { className: "legend" },
        element("span", { textContent: listed(this.objective.name, directionOf(this.objective)) }),
        element("span", { className: "bar-of-colours" }, ...colourBar(nicheColour, short(low), most)),
        swatch("empty", "empty"),
        isFine ? null : swatch("filmed", "with a film"),
      ),
      element(
        "div",
        { className: "map" },
        this.grid,
        ...axisParts(axes[0], "x", "left"),
        ...(axes.length > 1 ? axisParts(axes[1], "y", "bottom") : []),
      ),
      this.info,
    );
  }

  /** Outlines the cells of the robots with these indices. */
  show(indices) {
    const shown = this.cells.filter(({ robot }) => indices.includes(robot));
    for (const { button } of this.cells) button.removeAttribute("aria-current");
    for (const { button } of shown) button.setAttribute("aria-current", "true");
    this.#reach(shown[0] ?? this.reached ?? this.cells[0]);
  }

  /** Makes a cell the one that the Tab key goes to. */
  #reach(cell) {
    this.reached = cell;
    for (const { button } of this.cells) button.tabIndex = button === cell.button ? 0 : -1;
  }

  #focused(cell) {
    this.#reach(cell);
    this.#explain(cell);
  }

  #clicked(cell) {
    cell.button.focus(); // not every browser does so
    this.#explain(cell);
    if (cell.robot !== undefined) this.viewer?.open(cell.robot);
  }

  /** Goes to another robot: left and right as one reads, up and down to the nearest one of the next row that has any. */
  #pressed(event) {
    const from = this.cells.findIndex(({ button }) => button === event.target);
    const { column, row } = this.cells[from];
    const inRow = (next) => {
      const there = this.cells.filter((cell) => cell.row === next?.row);
      return there.sort((a, b) => Math.abs(a.column - column) - Math.abs(b.column - column))[0];
    };
    const moves = {
      ArrowLeft: () => this.cells[from - 1],
      ArrowRight: () => this.cells[from + 1],
      ArrowUp: () => inRow(this.cells.findLast((cell) => cell.row > row)),
      ArrowDown: () => inRow(this.cells.find((cell) => cell.row < row)),
    };
    if (!Object.hasOwn(moves, event.key) || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    event.stopPropagation(); // these keys also steer the film
    moves[event.key]()?.button.focus();
  }

  #pointed({ clientX, clientY }) {
    const { left, bottom, width, height } = this.grid.getBoundingClientRect();
    const bin = (part, bins) => Math.min(bins - 1, Math.max(0, Math.floor(part * bins)));
    const column = bin((clientX - left) / width, this.columns);
    const row = bin((bottom - clientY) / height, this.rows);
    this.#explain(this.at.get(this.#place({ column, row })) ?? { column, row });
  }

  #textOf({ column, row, individual, value, robot }) {
    const ranges = this.run.map.axes.map((axis, i) => rangeText(axis, [column, row][i])).join(", ");
    if (individual === undefined) return `${ranges}: empty`;
    const elite = `${ranges}: individual ${individual}, ${quantityText(value, this.objective)}`;
    return robot === undefined ? `${elite}; it has no film on this page` : elite;
  }

  /** Writes about a cell or, without one, about the map. */
  #explain(cell) {
    if (cell === this.explained && this.info.hasChildNodes()) return;
    this.explained = cell;
    const hasFilm = cell ? cell.robot !== undefined : this.cells.some(({ robot }) => robot !== undefined);
    const isEmpty = cell && cell.individual === undefined;
    const text = cell ? this.#textOf(cell) : `${this.cells.length} of ${this.run.map.cells} cells hold a robot`;
    const invitation = cell ? [] : [". Click one to see it."];
    this.info.replaceChildren(text, ...(hasFilm || isEmpty ? invitation : this.#advice(cell)));
  }

  /** Returns a sentence on how to get the film of the robot in a cell or, without a cell, of any robot. */
  #advice(cell) {
    const command = `evodevo report ${shellWord(this.run.folder)} --individual ${cell?.individual ?? "ID"}`;
    return [`. To film ${cell ? "it" : "one"}, run `, element("code", { textContent: command })];
  }
}

/** The maps of all runs that have one. The same colour means the same value in each. */
export class NicheMaps {
  constructor(runs, robots, viewer) {
    const mapped = runs.filter((run) => run.map?.elites.length > 0);
    const objectiveOf = (run) => run.objectives.find(({ name }) => name === run.map.objective);
    this.list = mapped.map((run) => {
      const objective = objectiveOf(run);
      const alike = mapped.filter((other) => titled(objectiveOf(other)) === titled(objective));
      const values = alike.flatMap((other) => other.map.elites.map(({ value }) => value));
      const range = values.reduce(([low, high], v) => [Math.min(low, v), Math.max(high, v)], [Infinity, -Infinity]);
      const title = runs.length > 1 ? `Map of niches: ${run.label}` : "Map of niches";
      return new NicheMap(run, title, objective, range, robots, viewer);
    });
    this.figures = this.list.map(({ root }) => root);
  }

  /** Outlines the cells of the robots with these indices. */
  show(indices) {
    this.list.forEach((map) => map.show(indices));
  }
}
