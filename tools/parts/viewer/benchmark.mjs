// Prints the time that the page's JavaScript needs for each frame of a life: node benchmark.mjs PAGE.html
// WebGL's drawing and copying functions are disabled, because without a GPU the processor would execute them. The
// remaining time is what a laptop's processor spends while its GPU draws.
import { launch, opened } from "./browser.mjs";

const frames = 600;
const viewport = { width: 1280, height: 720 };

/** Replaces WebGL's functions that draw and copy with functions that do nothing. */
function drawNothing() {
  const names = ["drawElements", "drawArrays", "clear", "bufferData", "bufferSubData", "texImage2D", "texSubImage2D"];
  for (const name of names) WebGL2RenderingContext.prototype[name] = () => {};
}

/** Plays a life frame by frame; returns the time of each frame [ms], listing the first frames of cycles separately. */
async function play(count) {
  const { viewer } = await window.evodevo;
  const { life } = viewer.stages[0];
  const times = { within: [], first: [] };
  for (let i = 0; i <= count; ++i) {
    const was = life.shotAt(viewer.time);
    const before = performance.now();
    viewer.seek(viewer.begin + ((viewer.end - viewer.begin) * i) / count);
    viewer.draw();
    times[life.shotAt(viewer.time) === was ? "within" : "first"].push(performance.now() - before);
    if (i % 10 === 0) await new Promise((done) => setTimeout(done)); // other work, such as garbage collection
  }
  return { ...times, masses: life.massCount, springs: life.shots[0].springs.length };
}

const browser = await launch();
const tab = await opened(browser, process.argv[2], { viewport }, { before: drawNothing });
const { within, first, masses, springs } = await tab.evaluate(play, frames);
const at = (times, part) => `${times.sort((a, b) => a - b)[Math.floor(part * (times.length - 1))].toFixed(1)} ms`;
console.log(`${masses} masses, ${springs} springs`);
console.log(`a frame:                    median ${at(within, 0.5)}, 99 of 100 within ${at(within, 0.99)}`);
console.log(`the first frame of a cycle: median ${at(first, 0.5)}, longest ${at(first, 1)}`);
await browser.close();
