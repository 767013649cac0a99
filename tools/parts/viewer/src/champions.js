// The best robot of a run over the generations in which it changed, as a strip of pictures.
import { element } from "./elements.js";
import { Life } from "./life.js";
import { quantityText } from "./scores.js";
import { drawStill } from "./still.js";

const side = 160; // pixels; twice the size at which pictures are shown

export class Champions {
  /** The strip of one run. `open` is called with an individual that is to be shown. */
  constructor(run, title, robots, open) {
    const { count, shown } = run.champions;
    const films = new Map(robots.filter((one) => one.run === run).map(({ robot }) => [robot.individual, robot.film]));
    this.pictures = shown.map(({ individual, film }) => ({
      film: films.get(individual) ?? film ?? { shots: [] },
      canvas: element("canvas", { width: side, height: side }),
    }));
    const all = count > shown.length ? `These are ${shown.length} of ${count}, evenly spaced. ` : "";
    const note = `${all}Each robot was the best so far when it was born, and is shown as it was born. A click on one with a coloured frame opens it.`;
    const item = ({ individual, generation, value }, i) =>
      element(
        "li",
        {},
        element(
          "button",
          { type: "button", className: films.has(individual) ? "" : "absent", onclick: () => open(individual) },
          this.pictures[i].canvas,
          element("b", { textContent: quantityText(value, run.objectives[0]) }),
          element("span", { textContent: ` generation ${generation} ` }),
          element("span", { textContent: `individual ${individual} ` }),
          films.has(individual) ? null : element("span", { textContent: "not on the page" }),
        ),
      );
    this.root = element(
      "figure",
      { className: "champions" },
      element("figcaption", { textContent: title }),
      element("ol", {}, ...shown.map(item)),
      element("p", { className: "note", textContent: note }),
    );
  }

  async draw() {
    for (const { film, canvas } of this.pictures) {
      const context = canvas.getContext("2d");
      context.clearRect(0, 0, side, side);
      const born = await Life.of({ film: { ...film, shots: film.shots.slice(0, 1) } });
      if (born.shots.length > 0) drawStill(born, context, 1, born.begin);
    }
  }
}
