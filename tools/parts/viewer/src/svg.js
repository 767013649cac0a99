// Charts as SVG.
const ns = "http://www.w3.org/2000/svg";

function node(tag, attributes, ...children) {
  const made = document.createElementNS(ns, tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, String(value));
  made.append(...children);
  return made;
}

const round = (x) => Math.round(100 * x) / 100;

/** Returns a chart of uPlot as a file in SVG, with the title above it and the names of the series below it. */
export function chartSvg(plot, title, data) {
  const { left, top, width, height } = plot.over.getBoundingClientRect();
  const whole = plot.root.getBoundingClientRect();
  const [x0, y0] = [left - whole.left, top - whole.top + 24];
  const soft = plot.axes[0].stroke();
  const at = (value, scale) => round(plot.valToPos(value, scale));
  const text = (x, y, content, attributes = {}) =>
    node("text", { x: round(x), y: round(y), fill: soft, "font-size": 12, ...attributes }, content);
  const [across, up] = plot.axes;
  const ticks = (axis) => (axis._splits ?? []).map((split, i) => [split, axis._values[i]]).filter(([, value]) => value);
  const inside = node("g", { transform: `translate(${round(x0)} ${round(y0)})` });
  inside.append(
    ...ticks(up).flatMap(([split, value]) => [
      node("path", { d: `M0 ${at(split, "y")}H${round(width)}`, stroke: soft, "stroke-opacity": 0.25 }),
      text(-8, at(split, "y") + 4, value, { "text-anchor": "end" }),
    ]),
    ...ticks(across).map(([split, value]) => text(at(split, "x"), height + 16, value, { "text-anchor": "middle" })),
    text(width / 2, height + 34, across.label, { "text-anchor": "middle" }),
    text(0, 0, up.label, { "text-anchor": "middle", transform: `translate(${round(-x0 + 12)} ${round(height / 2)}) rotate(-90)` }),
    node("clipPath", { id: "inside" }, node("rect", { width: round(width), height: round(height) })),
    node(
      "g",
      { "clip-path": "url(#inside)" }, // a chart may show a part of its data
      ...plot.series.slice(1).map((series, i) => shape(plot, series, data[0], data[i + 1])),
    ),
  );
  const names = plot.series.slice(1).map((series, i) => {
    const colour = colourOf(series.fill, plot) ?? colourOf(series.stroke, plot);
    const y = y0 + height + 54 + 18 * i;
    return node("g", {}, node("rect", { x: x0, y: y - 9, width: 14, height: 9, fill: colour }), text(x0 + 20, y, series.label));
  });
  const size = [round(whole.width), round(y0 + height + 48 + 18 * names.length)];
  const root = node(
    "svg",
    { xmlns: ns, width: size[0], height: size[1], viewBox: `0 0 ${size.join(" ")}`, "font-family": "system-ui, sans-serif" },
    text(x0, 16, title, { "font-size": 14, "font-weight": 600 }),
    inside,
    ...names,
  );
  return new XMLSerializer().serializeToString(root);
}

const colourOf = (colour, plot) => (typeof colour === "function" ? colour(plot, 1) : colour);

/** Returns a series as circles (`dots`), or as a line with `steps` at the end (1) or the beginning (-1) of an interval. */
function shape(plot, series, xs, ys) {
  const all = xs.map((x, i) => [round(plot.valToPos(x, "x")), ys[i] === null ? null : round(plot.valToPos(ys[i], "y"))]);
  const points = all.filter(([, y]) => y !== null);
  const fill = colourOf(series.fill, plot);
  if (series.dots) return node("g", { fill }, ...points.map(([cx, cy]) => node("circle", { cx, cy, r: 3.5 })));
  const next = { 1: ([x, y]) => `H${x}V${y}`, "-1": ([x, y]) => `V${y}H${x}` }[series.steps] ?? (([x, y]) => `L${x} ${y}`);
  let isJoined = false; // whether a line leads to the next point
  const d = all
    .map((point) => {
      if (point[1] === null) return (isJoined &&= series.spanGaps !== false), "";
      const part = isJoined ? next(point) : `M${point.join(" ")}`;
      isJoined = true;
      return part;
    })
    .join("");
  if (!fill) return node("path", { d, fill: "none", stroke: colourOf(series.stroke, plot), "stroke-width": 2, ...dash(series) });
  const floor = round(plot.valToPos(plot.scales.y.min, "y"));
  return node("path", { d: `${d}V${floor}H${points[0]?.[0] ?? 0}Z`, fill });
}

const dash = (series) => (series.dash ? { "stroke-dasharray": series.dash.join(" ") } : {});
