// The legend of the colours on the stage, and what else is to be seen there.
import { colourBar, css, cycleColour, materialColour, stressColour } from "./colours.js";
import { element, short, style } from "./elements.js";

const entry = (background, text) =>
  element(
    "span",
    { className: "swatch" },
    element("i", { style: `background:${background}` }),
    element("span", { textContent: text }),
  );
const swatch = (colour, text) => entry(css(colour), text);

/** Returns the legend of the colours of `mode`. `scale` holds the stress (N) and the number of shots that correspond to
 *  the last colour. */
export function legend(mode, stages, scale) {
  return [...colours[mode](stages, scale), ...faces(stages), ...changes(stages)];
}

const colours = {
  material: materials,
  stress: (_, scale) => colourBar(stressColour, "0 N", `${short(scale.stress)} N (root scale)`),
  cycle: (_, { cycles }) => {
    const born = swatch(cycleColour(0, cycles), "there from birth");
    const bar = (t) => cycleColour(1 + t * (cycles - 2), cycles);
    return cycles > 1 ? [born, ...colourBar(bar, "after cycle 1", `after cycle ${cycles - 1}`)] : [born];
  },
};

/** The materials that the robots' springs, or masses if there are no springs, have at any time: those of the experiment
 *  by name, and the number of others, which are mixtures of them, or have changed in life. */
function materials(stages) {
  const named = new Map();
  const others = new Map();
  for (const { life, materialNames, materialsSeen: ofSprings } of stages) {
    const all = life.robot.film.materials ?? [];
    const used = new Set(ofSprings.length > 0 ? ofSprings : life.massMaterials);
    for (const i of [...used].sort((a, b) => a - b)) {
      if (!(all[i]?.stiffness > 0)) continue;
      const colour = materialColour(all[i], all);
      if (i < materialNames.length) named.set(materialNames[i], colour);
      else others.set(JSON.stringify(all[i]), colour);
    }
  }
  const swatches = [...named].map(([name, colour]) => swatch(colour, name));
  return others.size > 0 ? [...swatches, mixtures([...others.values()])] : swatches;
}

function mixtures(all) {
  const shown = all.length === 1 ? [all[0], all[0]] : all.slice(0, 12);
  const text = all.length === 1 ? "1 mixture or changed material" : `${all.length} mixtures or changed materials`;
  return entry(`linear-gradient(90deg,${shown.map(css).join(",")})`, text);
}

/** Where the colours of faces come from, if there are any. */
const faces = (stages) =>
  stages.some(({ hasSkin }) => hasSkin) ? [entry("var(--faces)", "a face: as the springs inside its voxel")] : [];

const onGround = (within) => entry(style("--touch"), `shown on the ground, within ${short(1000 * within)} mm`);

/** What glows and fades when a cycle begins, if springs come or go, which masses are on the ground, and its marks. */
function changes(stages) {
  const shots = stages.flatMap(({ life }) => life.shots);
  const ground = stages.map(({ touch }) => touch).filter(Number.isFinite);
  return [
    ...(shots.some(({ came }) => came > 0) ? [entry(style("--fresh"), "glows: new springs")] : []),
    ...(shots.some(({ gone }) => gone.length > 0) ? [entry("var(--faded)", "thick and fading: removed springs")] : []),
    ...(ground.length > 0 ? [onGround(Math.max(...ground))] : []),
    ...(stages.some(({ track }) => track) ? [entry(style("--accent"), "trail; a line after each body length")] : []),
  ];
}
