// The colours of springs, by material, by stress or by the cycle in which they were added, and those of niches.
import { element, style } from "./elements.js";

const mix = (a, b, t) => a.map((x, i) => x + (b[i] - x) * t);
const rgb = (hex) => [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16) / 255);
const ramp = (stops, t) => {
  const at = Math.min(0.9999, Math.max(0, t)) * (stops.length - 1);
  return mix(stops[Math.floor(at)], stops[Math.floor(at) + 1], at % 1);
};
export const css = (colour) => `rgb(${colour.map((x) => Math.round(255 * x)).join(" ")})`;

// read again whenever the theme changes
let palette;
export function readPalette() {
  const list = (name) => style(name).split(/\s+/).map(rgb);
  palette = {
    muscles: list("--muscles"),
    passive: list("--passive"),
    stress: list("--stress"),
    cycles: list("--cycles"),
    born: rgb(style("--born")),
    niches: list("--niches"),
  };
}

/** The colour of a material. A muscle's colour depends on its phase, and is stronger for larger amplitudes; a passive
*  material's colour depends on its stiffness. */
export function materialColour(material, all) {
  const most = Math.max(...all.map((m) => m.amplitude));
  const stiffest = Math.max(...all.map((m) => m.stiffness));
  const passive = ramp(palette.passive, stiffest > 0 ? material.stiffness / stiffest : 0);
  if (!(material.amplitude > 0)) return passive;
  const turns = material.phase / (2 * Math.PI);
  const phase = 1 - Math.abs(2 * (turns - Math.floor(turns)) - 1); // 0 … 1: in phase … in counter-phase
  return mix(passive, ramp(palette.muscles, phase), 0.35 + 0.65 * (material.amplitude / most));
}

/** The colour of stress; `part` is the square root of stress relative to the largest stress. */
export const stressColour = (part) => ramp(palette.stress, part);

export const cycleColour = (cameWith, shots) =>
  cameWith <= 0 ? palette.born : ramp(palette.cycles, shots > 2 ? (cameWith - 1) / (shots - 2) : 1);

/** The colour of a run, or of another series, by its index. */
export function runColour(index) {
  const colours = style("--series").split(/\s+/);
  return colours[index % colours.length];
}

/** Returns a colour of the style sheet, halfway to that of the page. */
export const faded = (colour) => css(mix(rgb(colour), rgb(style("--paper")), 0.5));

/** The colour of a niche; `part` is 0 for the lowest value and 1 for the highest one. */
export const nicheColour = (part) => ramp(palette.niches, part);

/** Returns the elements of a legend: a bar with the colours that colour() gives for 0 to 1, between two texts. */
export function colourBar(colour, low, high) {
  const stops = Array.from({ length: 9 }, (_, i) => css(colour(i / 8)));
  return [
    element("span", { textContent: low }),
    element("i", { className: "scale", style: `background:linear-gradient(90deg,${stops.join(",")})` }),
    element("span", { textContent: high }),
  ];
}

/** The number of shots up to the last one in which springs were added. */
export const developing = (life) => 1 + life.cameWith.reduce((last, index) => Math.max(last, index), 0);

/** Returns a function that gives the colour of the i-th spring of a shot. `scale` holds the stress (N) and the number
 *  of shots that correspond to the last colour. */
export function springColours(life, mode, scale) {
  const { materials, most_stress, stress_levels } = life.robot.film;
  if (mode === "stress") {
    const own = scale.stress > 0 ? Math.sqrt(most_stress / scale.stress) : 0;
    const levels = Array.from({ length: stress_levels + 1 }, (_, level) => stressColour((own * level) / stress_levels));
    return (shot, i) => levels[shot.stress[i] ?? 0];
  }
  if (mode === "cycle") {
    const colours = life.shots.map((_, index) => cycleColour(index, scale.cycles));
    return (shot, i) => colours[life.cameWith[shot.springs[i]]];
  }
  const colours = materials.map((made) => materialColour(made, materials));
  return (shot, i) => colours[shot.materials[i]];
}
