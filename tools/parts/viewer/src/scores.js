// What is known of an individual in numbers: its age, its objectives and its other scores.
import { element, short } from "./elements.js";

export const hasUnit = (unit) => unit !== "" && unit !== "1";

/** Returns a text such as "distance (m)". The unit "1", of a number without dimension, is left out. */
export const titled = ({ name, unit }) => (hasUnit(unit) ? `${name} (${unit})` : name);

/** Returns a text such as "0.1234 m". */
export const quantityText = (value, { unit }) => (hasUnit(unit) ? `${short(value)} ${unit}` : short(value));

/** Joins texts by commas, without the empty ones. */
export const listed = (...texts) => texts.filter((text) => text !== "").join(", ");

/** Returns a note for an objective for which low values are good; an empty text for other scores. */
export const directionOf = ({ maximise }) => (maximise === false ? "lower is better" : "");

/** Returns the objectives of a robot in the life that the page shows of it. */
export const inLifeShown = (robot) => robot.lives?.[robot.life - 1] ?? robot.objectives;

export const age = { name: "age", unit: "generations", group: "Age", better: -1, of: (individual) => individual.age };

/** Returns the objectives of all runs. Those with the same name and unit are one. `better` is 1 if high values are good,
*  -1 if low ones are, and 0 if neither are; of() returns an individual's value, or undefined if it has none. */
export function objectivesOf(runs) {
  return distinct(runs.flatMap((run) => run.objectives ?? [])).map((objective) => ({
    ...objective,
    group: "Objectives",
    better: objective.maximise ? 1 : -1,
    of: (individual) => own(individual.objectives, objective.name),
  }));
}

const groups = { descriptor: "Descriptors", constraint: "Constraints" };

/** Likewise the scores that are not objectives. */
export function measuresOf(runs) {
  return distinct(runs.flatMap((run) => run.measures ?? [])).map((measure) => ({
    ...measure,
    group: own(groups, measure.role) ?? "Measures",
    better: 0,
    of: (individual) => own(individual.measures, measure.name),
  }));
}

/** Likewise what selection notes about individuals, such as their novelty or species. */
export function notesOf(runs) {
  return distinct(runs.flatMap((run) => run.notes ?? [])).map((note) => ({
    ...note,
    of: (individual) => own(individual.notes, note.name),
  }));
}

/** Returns a value of an object by a name that anybody may have given, such as "constructor". */
export const own = (object, name) => (object && Object.hasOwn(object, name) ? object[name] : undefined);

const distinct = (scores) => [...new Map(scores.map((score) => [titled(score), score])).values()];

/** A control that chooses one of several scores. `chosen` is called with the score. */
export function scoreChooser(label, scores, first, chosen) {
  const groups = [...new Set(scores.map(({ group }) => group))];
  const option = (score) =>
    element("option", { value: String(scores.indexOf(score)), textContent: titled(score), selected: score === first });
  const optionsOf = (group) => scores.filter((score) => score.group === group).map(option);
  const options =
    groups.length === 1
      ? optionsOf(groups[0])
      : groups.map((group) => element("optgroup", { label: group }, ...optionsOf(group)));
  return element(
    "label",
    { className: "choice" },
    element("span", { textContent: label }),
    element("select", { onchange: (event) => chosen(scores[Number(event.target.value)]) }, ...options),
  );
}
