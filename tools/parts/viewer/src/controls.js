// The controls of the viewer. They call its functions; the viewer sets what they show.
import { element } from "./elements.js";
import { views } from "./views.js";

export const speeds = [0.1, 0.25, 0.5, 1, 2, 4];

export const linkLabel = "Copy link";

export class Controls {
  /** Creates the controls of a viewer: those `above` and `below` the stage, and the `last` ones, which stand below what is
   *  said of a picked mass or spring. */
  constructor(viewer) {
    this.above = [this.#pickers(viewer)];
    this.below = [this.#transport(viewer), this.#lifeBar(viewer)];
    this.last = [this.#looks(viewer), this.#leaving(viewer)];
    this.showPlaying(false);
  }

  /** Creates the controls that choose the robots shown. */
  #pickers(viewer) {
    const choose = (label, which, options) =>
      element(
        "label",
        { className: "choice" },
        element("span", { textContent: label }),
        element("select", { onchange: (e) => viewer.choose(which, e.target.value) }, ...options),
      );
    const options = () =>
      viewer.robots.map(({ label }, i) => element("option", { value: String(i), textContent: label }));
    this.first = choose("Robot", 0, options());
    this.second = choose("beside", 1, [element("option", { value: "", textContent: "none" }), ...options()]);
    return element("div", { className: "pickers" }, this.first, viewer.robots.length > 1 ? this.second : null);
  }

  /** Creates the controls of the clock. */
  #transport(viewer) {
    this.play = element("button", { className: "play", type: "button", onclick: () => viewer.toggle() });
    this.scrub = element("input", {
      type: "range",
      min: "0",
      max: "1",
      step: "any",
      value: "0",
      "aria-label": "Time",
      oninput: (e) => viewer.scrub(Number(e.target.value)),
    });
    this.clock = element("output", { className: "clock" });
    this.speedSelect = element(
      "select",
      { "aria-label": "Speed", onchange: (e) => viewer.setSpeed(Number(e.target.value)) },
      ...speeds.map((s) => element("option", { value: String(s), textContent: `${s}×`, selected: s === 1 })),
    );
    return element("div", { className: "transport" }, this.play, this.scrub, this.clock, this.speedSelect);
  }

  /** Creates the controls that go from cycle to cycle. */
  #lifeBar(viewer) {
    this.cycle = element("input", {
      type: "range",
      min: "0",
      max: "0",
      step: "1",
      value: "0",
      "aria-label": "Cycle of life",
      oninput: (e) => viewer.jump(Number(e.target.value)),
    });
    this.cycleName = element("output", { className: "cycle-name" });
    this.followBox = element("input", {
      type: "checkbox",
      checked: true,
      onchange: (e) => viewer.setFollow(e.target.checked),
    });
    this.thickBox = element("input", { type: "checkbox", onchange: (e) => viewer.setThick(e.target.checked) });
    this.skinBox = element("input", { type: "checkbox", onchange: (e) => viewer.setSkin(e.target.checked) });
    this.skin = element("label", { className: "check" }, this.skinBox, element("span", { textContent: "Skin" }));
    return element(
      "div",
      { className: "life" },
      element("label", {}, element("span", { textContent: "Life" }), this.cycle),
      this.cycleName,
      element("label", { className: "check" }, this.followBox, element("span", { textContent: "Follow" })),
      element("label", { className: "check" }, this.thickBox, element("span", { textContent: "Thick springs" })),
      this.skin,
      this.#viewPicker(viewer),
    );
  }

  #viewPicker(viewer) {
    const option = ([value, { label }]) => element("option", { value, textContent: label });
    this.viewSelect = element(
      "select",
      { onchange: (event) => viewer.setView(event.target.value) },
      ...Object.entries(views).map(option),
    );
    return element("label", {}, element("span", { textContent: "View" }), this.viewSelect);
  }

  /** Creates the buttons that take something out of the page, or fill the screen. */
  #leaving(viewer) {
    const button = (text, onclick) => element("button", { type: "button", textContent: text, onclick });
    this.linkButton = button(linkLabel, () => viewer.copyLink());
    return element(
      "div",
      { className: "leaving" },
      button("Full screen", () => viewer.fillScreen()),
      button("Save picture", () => viewer.savePicture()),
      button("Save body", () => viewer.saveBodies()),
      this.linkButton,
    );
  }

  /** Creates the choice of colours and their legend. */
  #looks(viewer) {
    const choice = ([mode, label]) =>
      element(
        "label",
        {},
        element("input", {
          type: "radio",
          name: "colour",
          value: mode,
          checked: mode === viewer.mode,
          onchange: () => viewer.setMode(mode),
        }),
        element("span", { textContent: label }),
      );
    this.modes = element(
      "fieldset",
      { className: "modes" },
      element("legend", { textContent: "Colour" }),
      ...Object.entries({ material: "Material", stress: "Stress", cycle: "Came in" }).map(choice),
    );
    this.legend = element("div", { className: "legend" });
    return element("div", { className: "looks" }, viewer.works ? this.modes : null, this.legend);
  }

  showPlaying(isPlaying) {
    this.play.textContent = isPlaying ? "❚❚" : "▶";
    this.play.setAttribute("aria-label", isPlaying ? "Pause" : "Play");
  }
}

/** The list of keys. */
export const keys = () =>
  element(
    "details",
    { className: "keys" },
    element("summary", { textContent: "Keys" }),
    element("p", {
      textContent:
        "Space plays and pauses. ← and → step by a frame, with Shift by a second. [ and ] go from cycle to cycle. + and − change the speed. C changes the colour, F follows, T makes springs thick, S covers voxels with a skin, R turns the camera back, V fills the screen. A click on a mass or a spring says what it is and shows what it does over time. Drag turns, the wheel (after a click) or two fingers zoom, right drag or two fingers move.",
    }),
  );
