// A still picture of a robot for browsers without WebGL.
import { css, springColours } from "./colours.js";
import { element } from "./elements.js";
import { Life } from "./life.js";

const [width, height] = [960, 420]; // pixels

/** Returns a picture of a robot at the end of its life, seen along y, and a sentence that says why it is still. */
export async function stillOf({ robot, label, run }) {
  const life = await Life.of(robot, run.direction);
  const canvas = element("canvas", { width, height, role: "img", "aria-label": `${label}, at the end of its life` });
  if (life.shots.length > 0) drawStill(life, canvas.getContext("2d"), 2);
  const why = "This browser shows no 3D graphics (WebGL), so the robot does not move. Charts and tables are complete.";
  return element(
    "section",
    { className: "still" },
    canvas,
    element("p", { className: "note", textContent: `${label}. ${why}` }),
  );
}

/** Draws a robot at a time [s], by default the end of its life, into the middle of a canvas, with lines of a width in
 *  pixels. */
export function drawStill(life, context, lineWidth, time = life.end) {
  const { width, height } = context.canvas;
  const index = life.shotAt(time);
  const shot = life.shots[index];
  const places = new Float32Array(4 * life.massCount);
  life.writePositions(time, places);
  const [middle, size] = [life.middleAt(time, life.smoothPath), life.boxIn(index).size];
  const pixels = (0.8 * Math.min(width, height)) / size;
  const at = (mass) => [
    width / 2 + pixels * (places[4 * mass] - middle[0]),
    height / 2 - pixels * (places[4 * mass + 2] - middle[2]),
  ];
  const colourOf = springColours(life, "material");
  const depth = (spring) => places[4 * life.ends[2 * spring] + 1] + places[4 * life.ends[2 * spring + 1] + 1];
  // what is behind is drawn first
  const order = [...shot.springs.keys()].sort((a, b) => depth(shot.springs[b]) - depth(shot.springs[a]));
  context.lineWidth = lineWidth;
  for (const i of order) {
    const spring = shot.springs[i];
    context.strokeStyle = css(colourOf(shot, i));
    context.beginPath();
    context.moveTo(...at(life.ends[2 * spring]));
    context.lineTo(...at(life.ends[2 * spring + 1]));
    context.stroke();
  }
}
