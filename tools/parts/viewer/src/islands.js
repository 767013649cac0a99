// The migrants between the islands of a run.
import { element } from "./elements.js";
import { table } from "./tables.js";

const cell = (text) => element("td", { textContent: text });

/** Lists the individuals that came from other islands; nothing if no run of the page is an island with immigrants. */
export function migrantTables(runs) {
  const rows = runs
    .filter((run) => run.island)
    .flatMap((run) =>
      run.island.immigrants.map((one) =>
        element(
          "tr",
          {},
          cell(String(one.generation)),
          cell(`island ${one.from.island}, individual ${one.from.individual}`),
          cell(`island ${run.island.number}, individual ${one.individual}`),
          cell(one.died === null ? "lives" : `died in generation ${one.died}`),
        ),
      ),
    );
  if (rows.length === 0) return [];
  const heads = ["Generation", "From", "To", "Fate"].map((text) => element("th", { textContent: text, scope: "col" }));
  return [table("migrants", "Migrants", [element("tr", {}, ...heads)], rows)];
}
