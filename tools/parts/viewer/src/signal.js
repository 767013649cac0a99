// What selection sees of the scores of a run, and what children inherit, if it was measured.
import { element, short } from "./elements.js";
import { table } from "./tables.js";

const heads = ["Robots", "Quantity", "Of", "Scale", "Value", "95 % interval", "Count"];

/** A section for each run that was measured: sentences, and the numbers from which they follow. */
export function signalTables(runs) {
  return runs.filter(({ signal }) => signal).map((run) => {
    const title = "What repeats, and what children inherit";
    const made = table("signal", runs.length > 1 ? `${title}: ${run.label}` : title, [line(heads, "th")], run.signal.numbers.map(row));
    made.querySelector("h2").after(...run.signal.sentences.map((text) => element("p", { textContent: text })));
    return made;
  });
}

const line = (texts, tag) => element("tr", {}, ...texts.map((text) => element(tag, { textContent: text })));

const row = ({ population, quantity, of, scale, value, low, high, count }) =>
  line([population, quantity, of, scale, short(value), low === null ? "–" : `${short(low)} to ${short(high)}`, String(count)], "td");
