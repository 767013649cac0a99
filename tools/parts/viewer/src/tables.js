// The tables of a report: the robots, and the scores of the robots shown in each test.
import { runColour } from "./colours.js";
import { element, short } from "./elements.js";
import { directionOf, inLifeShown, listed, measuresOf, notesOf, objectivesOf, own, titled } from "./scores.js";

const cell = (text, tag = "td") => element(tag, { textContent: text });

/** A section with a title and a table. */
export function table(name, title, heads, rows) {
  return element(
    "section",
    { className: `table ${name}` },
    element("h2", { textContent: title }),
    element(
      "div",
      { className: "scroll" },
      element("table", {}, element("thead", {}, ...heads), element("tbody", {}, ...rows)),
    ),
  );
}

/** The facts of several runs, each {label, value, note}: a column for each run, a row for each fact that any has. */
export function factTable(runs, facts) {
  const labels = [...new Set(facts.flatMap((of) => of.map(({ label }) => label)))];
  const ofRun = (of, label) => {
    const fact = of.find((one) => one.label === label);
    return element("td", {}, ...(fact ? [element("b", { textContent: fact.value }), ` ${fact.note}`] : ["–"]));
  };
  const rows = labels.map((label) =>
    element("tr", {}, element("th", { textContent: label, scope: "row" }), ...facts.map((of) => ofRun(of, label))),
  );
  const heads = runs.map(({ label, experiment, seed }) => {
    const [swatch, of] = [element("i", { className: "run-colour" }), ` ${experiment}, seed ${seed}`];
    return element("th", {}, swatch, label, element("span", { textContent: of }));
  });
  const made = table("facts-of-runs", "Runs", [element("tr", {}, cell("Fact", "th"), ...heads)], rows);
  colourRuns(made);
  return made;
}

/** Gives the runs in a table their colours, which depend on the theme. */
export function colourRuns(root) {
  root.querySelectorAll(".run-colour").forEach((swatch, i) => (swatch.style.background = runColour(i)));
}

/** Lists those robots of the page for which `isListed` holds, with their scores. They can be opened if there is a viewer. */
export function robotTable(runs, robots, isListed, viewer) {
  const objectives = objectivesOf(runs);
  const measures = measuresOf(runs);
  const notes = notesOf(runs);
  const listedOnes = [...robots.entries()].filter(([, one]) => isListed(one));
  const rows = listedOnes.map(([i, { run, robot }]) =>
    element(
      "tr",
      {},
      element(
        "td",
        {},
        viewer
          ? element("button", { type: "button", textContent: robot.role, onclick: () => viewer.open(i) })
          : robot.role,
      ),
      ...(runs.length > 1 ? [cell(run.label)] : []),
      cell(String(robot.individual)),
      ...objectives.map((objective) => cell(scoreText(robot, objective, again(run, robot, objective)))),
      ...measures.map((measure) => cell(scoreText(robot, measure, ""))),
      ...notes.map((note) => cell(noteText(note.of(robot), note))),
      cell(String(robot.generation)),
      cell(String(robot.age)),
      cell(robot.made_by),
      cell(robot.ancestry.length > 0 ? robot.ancestry.join(" ‹ ") : "none"),
    ),
  );
  const heads = [
    "Robot",
    ...(runs.length > 1 ? ["Run"] : []),
    "Individual",
    ...[...objectives, ...measures, ...notes].map(titled),
    "Born",
    "Age",
    "Made by",
    "First parents",
  ];
  return table("robots", "Robots shown", [element("tr", {}, ...heads.map((text) => cell(text, "th")))], rows);
}

function scoreText(robot, score, note) {
  const value = score.of(robot);
  if (value !== undefined) return short(value) + note;
  return robot.status === "ok" ? "–" : robot.status;
}

/** Returns what selection noted about a robot; a number that names a group is not rounded. */
const noteText = (value, note) => (note.is_label && value !== undefined ? String(value) : short(value));

/** Returns a note if an objective in the life shown differs from that in the archive. If the robot was tested in
 *  scenarios, the life shown is that of one test, and its note stands there. */
function again(run, robot, objective) {
  return run.filmed_scenario ? "" : asShown(run, robot, objective.name, own(inLifeShown(robot), objective.name));
}

/** Returns a note if a score in the life shown differs from `value`, that in the archive, by more than 1 %, for example
 *  because it was simulated on another device. */
function asShown(run, robot, objective, value) {
  const shown = robot.again[run.objectives.findIndex(({ name }) => name === objective)];
  return shown === undefined || Math.abs(shown - value) <= 0.01 * Math.abs(value) ? "" : ` (as shown: ${short(shown)})`;
}

/** Returns the name of a test: that of its scenario and, if there are several, the numbers of the repeat and of the life. */
function testName({ life, scenario, repeat }, tests) {
  const isRepeated = tests.some((other) => other.scenario === scenario && other.repeat > 1);
  const name = isRepeated ? `${scenario}, repeat ${repeat}` : scenario;
  return tests.some((other) => other.life > 1) ? `life ${life}, ${name}` : name;
}

/** The scores in each test of the robots in the viewer; nothing if they were not tested in scenarios. */
export class TestTable {
  constructor(robots) {
    this.robots = robots;
    this.root = element("div");
  }

  /** Shows the tests of the robots with these indices. */
  show(indices) {
    const tested = indices.map((i) => this.robots[i]).filter(({ robot }) => robot.scenarios?.length > 0);
    this.root.replaceChildren(...(tested.length > 0 ? [table("tests", "Scores by test", heads(tested), rows(tested))] : []));
  }
}

/** How the robots in the viewer kept their fitness in each trial of their verification; nothing if none was verified. */
export class VerificationTable {
  constructor(robots) {
    this.robots = robots;
    this.root = element("div");
  }

  /** Shows the verifications of the robots with these indices. */
  show(indices) {
    const verified = indices.map((i) => this.robots[i]).filter(({ robot }) => robot.verification);
    this.root.replaceChildren(...(verified.length > 0 ? [this.#table(verified)] : []));
  }

  #table(verified) {
    const names = [...new Set(verified.flatMap(({ robot }) => robot.verification.trials.map(({ trial }) => trial)))];
    const head = ["Trial", ...verified.map(({ name }) => name)].map((text) => cell(text, "th"));
    const row = (name) =>
      element(
        "tr",
        {},
        element("th", { textContent: name, scope: "row" }),
        ...verified.map(({ robot }) => cell(trialText(robot.verification, name))),
      );
    return table("verification", "Verification", [element("tr", {}, ...head)], names.map(row));
  }
}

/** Returns the fitness in a trial, its share of the fitness in percent, and whether it held. */
function trialText({ fitness, trials }, name) {
  const trial = trials.find((other) => other.trial === name);
  if (!trial) return "–";
  const held = trial.held ? "held" : name === "no-muscles" ? "not held, as it should be" : "not held";
  if (trial.status !== "ok") return listed(trial.status, trial.reason, held);
  const percent = fitness === 0 ? "" : `${Math.round((100 * trial.value) / fitness)} %`;
  return listed(short(trial.value), percent, held);
}

function heads(tested) {
  const spans = tested.map(({ run, name }) =>
    element("th", { textContent: name, colSpan: run.objectives.length, scope: "colgroup" }),
  );
  const names = tested.flatMap(({ run }) =>
    run.objectives.map((o) => cell(listed(titled(o), directionOf(o)), "th")),
  );
  return [element("tr", {}, cell(""), ...spans), element("tr", {}, cell("Test", "th"), ...names)];
}

function rows(tested) {
  const names = [
    ...new Set(tested.flatMap(({ robot }) => robot.scenarios.map((test) => testName(test, robot.scenarios)))),
  ];
  const testOf = (robot, name) => robot.scenarios.find((test) => testName(test, robot.scenarios) === name);
  const isFilmed = ({ run, robot }, name) => {
    const test = testOf(robot, name);
    return test?.life === robot.life && test?.scenario === run.filmed_scenario && test?.repeat === 1;
  };
  const scoreIn = (one, name, objective) => {
    const value = own(testOf(one.robot, name)?.objectives, objective);
    return short(value) + (isFilmed(one, name) ? asShown(one.run, one.robot, objective, value) : "");
  };
  const row = (name, note, textOf) =>
    element(
      "tr",
      {},
      element("th", { scope: "row" }, name, note ? element("span", { textContent: note }) : null),
      ...tested.flatMap((one) => one.run.objectives.map((o) => cell(textOf(one, o.name)))),
    );
  return [
    ...names.map((name) => {
      const note = tested.some((one) => isFilmed(one, name)) ? "in the film" : "";
      return row(name, note, (one, objective) => scoreIn(one, name, objective));
    }),
    row("combined", "", ({ robot }, objective) => short(own(robot.objectives, objective))),
  ];
}
