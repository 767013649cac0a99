// Small helpers for building the page. Text is never interpreted as markup.

/** Creates an element with properties, and children that are elements or text. */
export function element(tag, properties = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (name in made) made[name] = value;
    else made.setAttribute(name, value);
  }
  made.append(...children.filter((child) => child !== null));
  return made;
}

/** Tells whether the reader prefers pages that do not move. */
export const prefersStill = () => matchMedia("(prefers-reduced-motion: reduce)").matches;

/** Returns a number and the name of what is counted. */
export const counted = (number, one, several = `${one}s`) => `${number.toLocaleString("en")} ${number === 1 ? one : several}`;

/** Formats a number with four significant digits, or three and a power of ten, without trailing zeros. */
export function short(value) {
  if (value === null || value === undefined) return "–";
  if (value !== 0 && (Math.abs(value) >= 1e5 || Math.abs(value) < 1e-3)) {
    const [digits, power] = value.toExponential(2).split("e");
    return `${Number(digits)}·10${superscript(Number(power))}`;
  }
  return String(Number(value.toPrecision(4)));
}

function superscript(number) {
  return [...String(number)].map((c) => (c === "-" ? "⁻" : "⁰¹²³⁴⁵⁶⁷⁸⁹"[Number(c)])).join("");
}

/** Returns the value of a variable of the style sheet, such as a colour. */
export function style(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}
