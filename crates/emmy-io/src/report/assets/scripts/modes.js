// The page of natural modes: a table, and the mode that is chosen as a vibration.

// The shapes of modes: frame 0 is the body at rest, and a frame that adds a mode to it follows for each mode.
class ModeFrames extends Frames {
  constructor(run) {
    super(run);
    this.rest = super.readDisplacement(0).slice();
    this.points = this.points.map((x, i) => x + this.rest[i]);
    [this.times, this.steps] = [this.times.slice(1), this.steps.slice(1)];
  }

  readDisplacement(mode) {
    super.readDisplacement(mode + 1);
    for (let i = 0; i < 3 * this.n; i++) this.displacement[i] -= this.rest[i];
    return this.displacement;
  }
}

// The motion of a mode: the reference position and sin(2 pi t) times the shape, where the clock runs over one period.
class ModeViewer extends Viewer {
  get showsModes() {
    return true;
  }

  get factorName() {
    return "Amplitude";
  }

  magnifier() {
    return element("input", { type: "range", min: 0, max: 3, step: 0.05, value: 1, "aria-label": "Amplitude", oninput: () => this.frame() });
  }

  setFactors() {
    this.mode = 0;
    this.settings.perFrame = true;
  }

  framesOf(run) {
    return new ModeFrames(run);
  }

  frameAt() {
    return Math.max(this.frameOfMode, 0);
  }

  // Index of the frame; -1 if the page has no room for it.
  get frameOfMode() {
    return this.frames.steps.indexOf(this.current.modes[this.mode].mode);
  }

  scaleAt(time) {
    return this.frameOfMode < 0 ? 0 : Number(this.factor.value) * Math.sin(2 * Math.PI * time);
  }

  chooseMode(index) {
    this.mode = index;
    this.show(this.clock.time);
  }

  caption() {
    return nameOfMode(this.current, this.mode);
  }

  describe() {
    this.note.textContent = this.frameOfMode < 0 ? "not drawn: the page has no room for it" : "";
    return `${nameOfMode(this.current, this.mode)}. The size of a mode is arbitrary. ${this.current.frames.notes.join(" ")}`;
  }
}

function nameOfMode(run, index) {
  const { mode, frequency } = run.modes[index];
  const text = frequency > 0 ? [number(frequency, 5), unitOf(run, "frequency")].filter(Boolean).join(" ") : kindOfMode(run.modes[index]);
  return `Mode ${mode}: ${text}`;
}

// Modes without a frequency: rigid ones, and unstable ones, whose squared frequency is negative.
function kindOfMode({ frequency }) {
  return frequency < 0 ? "unstable" : frequency > 0 ? "" : "rigid";
}

function modeTable(run, choose) {
  const columns = [["frequency", "frequency"], ["period", "period"], ["angular_frequency", "angular frequency"], ...["x", "y", "z"].map((axis) => [`effective_mass_${axis}`, `effective mass ${axis}`]), ["residual", "residual"]].filter(([key]) => key in run.modes[0]);
  // Rounding beside the effective masses of other modes or directions.
  const least = 1e-6 * Math.max(...run.modes.flatMap((mode) => ["x", "y", "z"].map((axis) => mode[`effective_mass_${axis}`])));
  const text = (key, value) => number(key.startsWith("effective") && value < least ? 0 : value);
  const cell = (mode, key) => element("td", { "data-key": key }, text(key, mode[key]));
  const rows = run.modes.map((mode, i) => {
    const kind = kindOfMode(mode);
    const button = element("button", { class: "link", type: "button", onclick: () => choose(i) }, String(mode.mode));
    return element("tr", { onclick: () => choose(i), class: kind }, element("th", { scope: "row" }, button, " ", element("small", {}, kind)), ...columns.map(([key]) => cell(mode, key)));
  });
  const show = (index) => rows.forEach((row, i) => row.setAttribute("aria-selected", String(i === index)));
  const head = ["mode", ...columns.map(([key, name]) => inUnit(name, unitOf(run, key)))].map((name) => element("th", { scope: "col" }, name));
  const sums = columns.map(([key]) => (key.startsWith("effective") ? number(run.modes.reduce((sum, mode) => sum + mode[key], 0)) : ""));
  const foot = element("tr", {}, element("th", { scope: "row" }, "sum"), ...sums.map((sum) => element("td", {}, sum)));
  const table = element("table", { class: "runs modes" }, element("thead", {}, element("tr", {}, ...head)), element("tbody", {}, ...rows), element("tfoot", {}, foot));
  return { node: element("div", { class: "table-wrap" }, table), show };
}

async function showModes(manifest) {
  const id = (name) => document.getElementById(name);
  const run = await readRun(0, manifest.runs[0]);
  id("title").textContent = run.title ?? run.name;
  id("subtitle").textContent = `${run.name}, computed by Emmy ${run.version ?? manifest.version}`;
  const rigid = run.modes.filter((mode) => kindOfMode(mode) === "rigid").length;
  id("status").append(element("strong", {}, `${run.modes.length} natural modes`), rigid ? `, ${rigid} of them rigid` : "");
  document.title = `${run.title ?? run.name}: natural modes`;
  document.body.classList.add("of-modes");
  const clock = new Clock(0, 1, { seconds: 2, repeats: true });
  clock.set(0.25);
  let viewer = null, chosen = 0;
  const output = element("output", { "aria-live": "polite" });
  const choose = (index) => {
    chosen = Math.min(Math.max(index, 0), run.modes.length - 1);
    viewer?.chooseMode(chosen);
    table.show(chosen);
    output.replaceChildren(element("b", {}, nameOfMode(run, chosen)), ` (${chosen + 1} of ${run.modes.length})`);
  };
  const table = modeTable(run, choose);
  id("charts").append(table.node);
  if (run.frames) {
    document.querySelector(".stage").classList.add("with-viewer");
    viewer = new ModeViewer(id("viewer"), [run], clock);
    showModeControls(id("transport"), clock, output, (count) => choose(chosen + count), choose, run.modes.length - 1);
    id("transport").append(viewer.filmButton);
  }
  // The first mode that is not rigid.
  const elastic = run.modes.findIndex((mode) => kindOfMode(mode) !== "rigid");
  choose(elastic < 0 ? 0 : elastic);
  id("details").append(element("section", { class: "card" }, element("h2", {}, "Data"), fileList(run)), inputText(run, "Input, with all defaults"));
  const key = (name) => element("kbd", {}, name);
  id("foot").append(element("p", {}, key("space"), " plays, ", key("←"), " ", key("→"), " choose a mode, ", key("Home"), " ", key("End"), " the first and the last one. Drag the body to turn it, right button to shift, wheel (after a click) to zoom."),
    element("p", {}, `Written by Emmy ${manifest.version}. This file is complete: it loads nothing. 3D: OGL (Unlicense).`));
  giveRoom();
  if (!isStill.matches && run.frames) clock.play();
}

function showModeControls(place, clock, output, move, choose, last) {
  place.hidden = false;
  const { play, toggle, button, speed } = playControls(clock);
  const slider = element("input", { type: "range", min: 0, max: 1000, step: 1, "aria-label": "Phase" });
  slider.addEventListener("input", () => { clock.isPlaying = false; clock.set(slider.value / 1000); });
  clock.follow((time) => { slider.value = Math.round(1000 * time); });
  place.append(button("back", "Previous mode (left arrow)", () => move(-1)), play, button("forward", "Next mode (right arrow)", () => move(1)), slider, output, speed);
  onKeys({ " ": toggle, ArrowLeft: () => move(-1), ArrowRight: () => move(1), Home: () => choose(0), End: () => choose(last) });
}
