// The ancestors of the robots on the page, as trees: from left to right by the generation of birth.
import { colourBar, css, nicheColour } from "./colours.js";
import { element, short } from "./elements.js";
import { Life } from "./life.js";
import { listed, quantityText } from "./scores.js";
import { drawStill } from "./still.js";

const [laneHeight, margin, portrait] = [64, 30, 52]; // pixels
const ns = "http://www.w3.org/2000/svg";

/** Gives each individual a lane: the first child stays in the lane of its parent, further children get lanes below. */
function withLanes(lineage) {
  const nodes = new Map(lineage.map((one) => [one.individual, { ...one, children: [] }]));
  const roots = [];
  for (const node of nodes.values()) (nodes.get(node.parents[0])?.children ?? roots).push(node);
  let lanes = 0;
  const place = (first, lane) => {
    const waiting = [[first, lane]];
    while (waiting.length > 0) {
      const [node, its] = waiting.pop();
      node.lane = its ?? lanes++;
      // the last one that waits is placed first
      for (let i = node.children.length - 1; i >= 0; --i) waiting.push([node.children[i], i === 0 ? node.lane : undefined]);
    }
  };
  roots.forEach((root) => place(root, undefined));
  return { nodes: [...nodes.values()], lanes };
}

export class Lineage {
  /** The trees of one run. `open` is called with an individual that is to be shown. */
  constructor(run, title, robots, open) {
    this.run = run;
    this.open = open;
    const own = robots.filter((one) => one.run === run);
    this.shown = new Map(own.map(({ robot }) => [robot.individual, robot]));
    const { nodes, lanes } = withLanes(run.lineage);
    this.nodes = nodes;
    this.last = Math.max(1, ...nodes.map(({ generation }) => generation));
    const values = nodes.map(({ value }) => value).filter((value) => value !== null);
    this.range = [Math.min(...values), Math.max(...values)];
    this.info = element("p", { className: "note" });
    const height = `height:${laneHeight * lanes + 12}px`;
    this.root = element(
      "figure",
      { className: "lineage" },
      element("figcaption", { textContent: title }),
      element("div", { className: "legend" }, ...this.#legend()),
      element(
        "div",
        { className: "tree", style: height, onpointerleave: () => this.#explain() },
        this.#edges(laneHeight * lanes + 12),
        ...nodes.map((node) => this.#button(node)),
      ),
      this.info,
    );
    this.#explain();
  }

  #legend() {
    const [low, high] = this.range;
    const [objective] = this.run.objectives;
    if (!(low <= high)) return [];
    return [
      element("span", { textContent: objective.name }),
      element("span", { className: "bar-of-colours" }, ...colourBar(nicheColour, short(low), quantityText(high, objective))),
      element("span", { textContent: `generations 0 to ${this.last}, from left to right` }),
    ];
  }

  /** The place of an individual: percent of the width, without the margin, and pixels from the top. */
  #place({ generation, lane }) {
    return [generation / this.last, laneHeight * lane + laneHeight / 2];
  }

  #edges(height) {
    const svg = document.createElementNS(ns, "svg");
    svg.setAttribute("viewBox", `0 0 1000 ${height}`);
    svg.setAttribute("preserveAspectRatio", "none");
    svg.setAttribute("aria-hidden", "true");
    for (const parent of this.nodes)
      for (const child of parent.children) {
        const [[x1, y1], [x2, y2]] = [this.#place(parent), this.#place(child)];
        const path = document.createElementNS(ns, "path");
        path.setAttribute("d", `M${1000 * x1} ${y1}C${500 * (x1 + x2)} ${y1} ${500 * (x1 + x2)} ${y2} ${1000 * x2} ${y2}`);
        svg.append(path);
      }
    return svg;
  }

  #button(node) {
    const [x, y] = this.#place(node);
    const isShown = this.shown.has(node.individual);
    const [low, high] = this.range;
    const part = high > low ? (node.value - low) / (high - low) : 1;
    const colour = node.value === null ? "var(--rule)" : css(nicheColour(part));
    const button = element("button", {
      type: "button",
      className: isShown ? "born filmed" : "born",
      style: `left:calc(${margin}px + (100% - ${2 * margin}px) * ${x});top:${y}px;--fitness:${colour}`,
      "aria-label": this.#textOf(node),
      onfocus: () => this.#explain(node),
      onpointerenter: () => this.#explain(node),
      onclick: () => this.open(node.individual),
    });
    if (isShown) {
      node.picture = element("canvas", { width: 2 * portrait, height: 2 * portrait });
      button.append(node.picture);
    }
    return button;
  }

  #textOf({ individual, generation, made_by, parents, value }) {
    const from = parents.length > 0 ? `from ${parents.join(" and ")}` : "";
    const fitness = value === null ? "without a fitness" : quantityText(value, this.run.objectives[0]);
    return `individual ${individual}: ${listed(fitness, `born in generation ${generation}`, `${made_by} ${from}`.trim())}`;
  }

  #explain(node) {
    this.info.textContent = node ? this.#textOf(node) : "Each robot is joined to its first parent. Those with a picture can be opened.";
  }

  /** Draws the bodies of the robots on the page, at the end of their lives. */
  async draw() {
    for (const node of this.nodes.filter(({ picture }) => picture)) {
      const life = await Life.of(this.shown.get(node.individual));
      const context = node.picture.getContext("2d");
      context.clearRect(0, 0, 2 * portrait, 2 * portrait);
      if (life.shots.length > 0) drawStill(life, context, 1);
    }
  }
}
