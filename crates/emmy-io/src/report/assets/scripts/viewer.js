// The motion: the scene with its controls.

class Viewer {
  constructor(place, runs, clock) {
    Object.assign(this, { place, clock, runs: runs.filter((run) => run.frames) });
    const id = (name) => document.getElementById(name);
    [this.canvas, this.legend, this.note, this.foot, this.triad] = ["scene", "legend", "scene-note", "viewer-foot", "triad"].map(id);
    place.hidden = false;
    this.settings = { edges: true, ghost: true, arrow: true, follow: false, perFrame: false, perRegion: false };
    [this.hidden, this.scales, this.shownScales] = [new Set(), new Map(), []];
    this.factor = this.magnifier();
    this.addTools(id("viewer-tools"));
    this.choose(this.runs[0]);
    clock.follow((time) => this.show(time));
    new ResizeObserver(() => {
      this.scene?.resize();
      if (!this.orbit?.isMoved) this.fit();
      // A canvas of a new size is empty; the next picture would be too late.
      if (this.scene) this.drawNow();
    }).observe(this.canvas.parentNode);
    isDark.addEventListener("change", () => { this.scene?.setInk(); this.draw(); });
    this.canvas.addEventListener("keydown", (event) => this.key(event));
  }

  addTools(place) {
    const select = (label, changed) => {
      const node = element("select", { "aria-label": label, onchange: () => changed(node.value) });
      return node;
    };
    const toggle = (label, name, changed) => {
      const node = element("input", { type: "checkbox", onchange: () => { this.settings[name] = node.checked; changed(); } });
      node.checked = this.settings[name];
      this.toggles[name] = node;
      return element("label", {}, node, label);
    };
    this.toggles = {};
    this.colour = select("Colour by", (name) => { this.field = name; this.refresh(); });
    this.run = select("Run", (index) => this.choose(this.runs[index]));
    this.runs.forEach((run, i) => this.run.append(element("option", { value: i }, run.name)));
    const view = (label, name) => element("button", { class: "tool", type: "button", title: `look ${name}`, "aria-label": `look ${name}`, onclick: () => this.look(label) }, label);
    const views = element("span", { class: "views" }, view("x", "along x"), view("y", "along y"), view("z", "along z"), view("Reset", "from the side, at all of the motion"));
    const displacement = element("label", {}, `${this.factorName} `, this.factor);
    this.axis = select("Section across", () => this.refresh());
    this.axis.append(...["none", "x", "y", "z"].map((axis) => element("option", { value: axis === "none" ? "" : axis }, axis)));
    this.axis.title = "all beyond a plane of the reference configuration is cut away";
    this.cut = element("input", { type: "range", min: 0, max: 1000, value: 500, "aria-label": "Position of the section", oninput: () => this.refresh() });
    this.cutText = element("span");
    const noFilm = whyNoFilm();
    this.filmButton = element("button", { class: "film", type: "button", disabled: noFilm !== null, title: noFilm ?? "plays the motion once and saves it as WebM", onclick: () => this.record() }, "Save film");
    this.ofRegions = element("div", { class: "regions" });
    this.perRegion = toggle("Own ranges", "perRegion", () => this.refresh());
    this.perRegion.title = "the colours of each region span its own values";
    const isAtRest = this.showsModes || this.runs.every(isStatic);
    const ofRun = isAtRest ? [] : [toggle("Angular momentum", "arrow", () => this.refresh()), toggle("Follow", "follow", () => this.frame())];
    place.append(
      element("div", {}, this.runs.length > 1 ? element("label", {}, "Run ", this.run) : null,
        element("label", {}, "Colour ", this.colour), this.runs.length > 1 ? null : displacement,
        element("label", {}, "Section ", this.axis), this.cut, this.cutText),
      element("div", {}, this.runs.length > 1 ? displacement : null, toggle("Cells", "edges", () => this.refresh()), toggle("Reference", "ghost", () => this.refresh()),
        ...ofRun, views),
      this.ofRegions);
    this.range = choiceOf(["run", "frame"], (index) => {
      this.settings.perFrame = index === 1;
      this.refresh();
    });
    this.range.node.setAttribute("aria-label", "Range of the colours");
    this.range.node.title = "colours span the values of the whole run, or of the frame shown";
    [this.shownField, this.scale] = [element("span"), element("div")];
    this.legend.append(element("div", { class: "head" }, this.shownField, this.showsModes ? null : element("span", {}, "range of ", this.range.node)), this.scale);
    if (this.toggles.follow) this.toggles.follow.parentNode.title = "keep the body in the middle";
  }

  // Controls that show and hide regions, if there are several.
  addRegions() {
    const { regions } = this.frames;
    const of = ({ name }) => {
      const box = element("input", { type: "checkbox", onchange: () => {
        this.hidden[box.checked ? "delete" : "add"](name);
        this.refresh();
      } });
      box.checked = !this.hidden.has(name);
      return element("label", { "data-region": name }, box, name);
    };
    this.ofRegions.hidden = !regions.length;
    this.ofRegions.replaceChildren("Regions", ...regions.map(of), this.perRegion);
  }

  // The plane of the section; none if there is no section.
  section() {
    const axis = "xyz".indexOf(this.axis.value || "-");
    this.cut.hidden = this.cutText.hidden = axis < 0;
    if (axis < 0) return null;
    const low = this.reference.low[axis], high = this.reference.high[axis];
    const at = low + ((high - low) * this.cut.value) / 1000;
    this.cutText.textContent = [`${this.axis.value} ≤ ${number(at, 3)}`, unitOf(this.current, "displacement")].filter(Boolean).join(" ");
    return { axis, at };
  }

  // Plays the motion once, at the speed that is chosen, and saves it; or ends that.
  record() {
    if (this.film) {
      this.film.stop();
      return;
    }
    const { clock, filmButton } = this, span = clock.end - clock.start;
    this.film = new Film(this.canvas, this.current.name, () => {
      this.film = null;
      filmButton.textContent = "Save film";
    });
    filmButton.textContent = "Stop film";
    clock.pause();
    let passed = 0, last = performance.now();
    const tick = (now) => {
      if (!this.film) return;
      // A slow machine makes a slower film, not one with few pictures.
      passed += Math.min(Math.max(now - last, 0) / 1000, 0.25);
      last = now;
      clock.set(clock.start + Math.min(passed * clock.rate, span));
      // The last picture stands for a while.
      if (passed < span / clock.rate + 0.5) requestAnimationFrame(tick);
      else this.film.stop();
    };
    tick(last);
  }

  get factorName() {
    return "Displacement";
  }

  get showsModes() {
    return false;
  }

  // The control of the factor of displacements.
  magnifier() {
    return element("select", { "aria-label": "Displacement is magnified by", onchange: () => this.frame() });
  }

  setFactors() {
    const proposed = proposedFactor(this.frames.rangeOf("displacement")[1], this.reference.size);
    const factors = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 1e4, 1e5, 1e6, proposed];
    const options = [...new Set(factors)].sort((a, b) => a - b).map((factor) => element("option", { value: factor, selected: factor === proposed }, `× ${grouped(factor)}`));
    this.factor.replaceChildren(...options);
  }

  framesOf(run) {
    return new Frames(run);
  }

  // Index of the frame at a time.
  frameAt(time) {
    return lastBefore(this.frames.times, time);
  }

  // Factor of the displacements at a time.
  scaleAt() {
    return Number(this.factor.value);
  }

  // Shows a run.
  choose(run) {
    this.current = run;
    this.frames = this.framesOf(run);
    const { frames } = this;
    this.reference = frames.box(0);
    this.setFactors();
    this.colour.replaceChildren(...frames.fields.map((field) => element("option", { value: field.name }, field.label)));
    const kept = frames.fields.find((field) => field.name === this.field) ?? frames.fields.find((field) => field.name === "von_mises_stress") ?? frames.fields[0];
    this.field = this.colour.value = kept.name;
    this.settings.edges = frames.triangles.length < 30000;
    this.toggles.edges.checked = this.settings.edges;
    // Otherwise there is only round-off to show.
    this.turns = !this.showsModes && !isStatic(run) && !isRounding(run, "angular_momentum");
    this.momentum = ["x", "y", "z"].map((axis) => run.column(`angular_momentum_${axis}`));
    this.addRegions();
    this.start();
  }

  start() {
    const { frames } = this;
    try {
      if (this.scene) {
        // A canvas has one context; the next scene takes a new canvas.
        this.scene.gl.getExtension("WEBGL_lose_context")?.loseContext();
        const canvas = this.canvas.cloneNode();
        this.canvas.replaceWith(canvas);
        this.canvas = canvas;
        canvas.addEventListener("keydown", (event) => this.key(event));
      }
      this.scene = new Scene(this.canvas, frames);
    } catch (error) {
      this.note.textContent = "The motion needs WebGL 2, which this browser does not offer here; the charts do not need it.";
      this.scene = null;
      return;
    }
    this.orbit = new Orbit(this.scene.camera, this.canvas, () => this.draw());
    this.isPlane = frames.triangles.length > 0 && isFlat(frames, this.reference);
    this.orbit.up = this.isPlane || (!frames.triangles.length && this.reference.high[2] === this.reference.low[2]) ? [0, 1, 0] : [0, 0, 1];
    // In a plane it points at the eye.
    if (this.toggles.arrow) this.settings.arrow = this.toggles.arrow.checked = this.settings.arrow && !this.isPlane;
    this.scene.setInk();
    this.scene.resize();
    this.frame();
    this.look("Reset");
    this.canvas.addEventListener("webglcontextlost", (event) => event.preventDefault());
  }

  // Sets the view so that the whole motion fits.
  frame() {
    this.motion = this.frames.box(Number(this.factor.value), this.showsModes);
    this.shown = null;
    if (!this.hasChosenFollow && this.toggles.follow) {
      this.settings.follow = this.toggles.follow.checked || this.current.is_driven || this.motion.size > 2.5 * this.reference.size;
      this.toggles.follow.checked = this.settings.follow;
      this.hasChosenFollow = true;
    }
    this.fit();
    this.refresh();
  }

  // Sets the distance from which the whole motion is in sight; a body that is followed may turn.
  fit() {
    const { orbit, settings, motion, reference } = this;
    orbit?.fit(settings.follow ? null : motion, 0.6 * reference.size);
  }

  look(from) {
    const turn = this.orbit.up[1] === 1 ? Math.PI / 2 : 0;
    const views = { x: [0, 0], y: [-Math.PI / 2, 0], z: [-Math.PI / 2, 1.5607], Reset: [-1.0, 0.42] };
    const plane = { x: [Math.PI / 2, 0], y: [0, 1.5607], z: [0, 0], Reset: this.isPlane || turn ? [0, 0] : [-1, 0.42] };
    const [azimuth, elevation] = (turn ? plane : views)[from];
    this.orbit.look(azimuth, elevation);
    this.frame();
  }

  key(event) {
    const turns = { ArrowLeft: [-0.12, 0], ArrowRight: [0.12, 0], ArrowUp: [0, 0.12], ArrowDown: [0, -0.12] };
    if (event.shiftKey && turns[event.key]) this.orbit.turn(...turns[event.key]);
    else if (event.key === "+" || event.key === "=") this.orbit.zoom(0.9);
    else if (event.key === "-") this.orbit.zoom(1.1);
    else return;
    event.preventDefault();
    event.stopPropagation();
  }

  refresh() {
    this.shown = null;
    this.show(this.clock.time);
  }

  show(time) {
    if (!this.scene) return;
    const frame = this.frameAt(time), scale = this.scaleAt(time);
    if (this.shown !== frame) {
      this.shown = frame;
      this.showFrame(frame);
    }
    if (this.shownScale !== scale) {
      this.shownScale = scale;
      this.middle = this.scene.setFrame(scale);
    }
    this.setArrow(time);
    this.draw();
  }

  showFrame(frame) {
    const { frames, scene, settings } = this;
    const field = frames.fields.find((field) => field.name === this.field);
    const shown = frames.regions.filter(({ name }) => !this.hidden.has(name));
    const isWhole = shown.length === frames.regions.length;
    // Regions that share a scale; none stands for all nodes.
    const groups = settings.perRegion && frames.regions.length ? shown.map((region) => [region]) : [isWhole ? [null] : shown];
    const ranges = (of) => groups.map((group) => group.map(of).reduce(union, [Infinity, -Infinity]));
    const ofRun = settings.perFrame ? null : ranges((region) => frames.rangeOf(this.field, region));
    frames.readDisplacement(frame);
    frames.readField(this.field, frame);
    const automatic = (ofRun ?? ranges((region) => frames.bounds(region))).map((range) => usable(range, field.signed));
    this.showLegend(field, groups.map(([region]) => (settings.perRegion && region ? region.name : null)));
    const limits = this.shownScales.map((scale, i) => scale.limits(automatic[i]));
    scene.setScales(groups.flatMap((group, i) => group.map((region) => ({ region, low: limits[i][0], high: limits[i][1] }))));
    scene.setShown(this.hidden, this.section());
    scene.setMap(mapOf(field));
    this.shownScale = this.scaleAt(this.clock.time);
    this.middle = scene.setFrame(this.shownScale);
    if (scene.cellEdges) scene.cellEdges.visible = settings.edges;
    if (scene.ghost) scene.ghost.visible = settings.ghost;
    this.orbit.target = settings.follow ? this.middle : this.motion.centre;
    this.canvas.dataset.frame = frame;
  }

  // Shows a scale for each title. Scales keep the limits that were typed.
  showLegend(field, titles) {
    this.shownField.textContent = inUnit(field.label, unitOf(this.current, field.array));
    this.range.show(this.settings.perFrame ? 1 : 0);
    const keys = titles.map((title) => `${field.name} ${title}`);
    if (this.legend.dataset.shown === keys.join()) return;
    this.legend.dataset.shown = keys.join();
    this.shownScales = keys.map((key, i) => {
      if (!this.scales.has(key)) this.scales.set(key, new Scale(titles[i], mapOf(field), () => this.refresh()));
      return this.scales.get(key);
    });
    this.scale.replaceChildren(...this.shownScales.map(({ node }) => node));
  }

  // The arrow of angular momentum starts in the middle of the body; its length is proportional to |L|.
  setArrow(time) {
    if (!this.turns) {
      this.scene.arrows.forEach((mesh) => { mesh.visible = false; });
      return;
    }
    const row = lastBefore(this.current.time, time);
    const L = this.momentum.map((component) => component[row]);
    const size = Math.hypot(...L), { arrow, arrows } = this.scene;
    const isShown = this.settings.arrow && size > 1e-9 * this.current.largest.angular_momentum;
    arrows.forEach((mesh) => { mesh.visible = isShown; });
    if (!isShown) return;
    arrow.start.value = this.middle;
    arrow.along.value = L.map((x) => x / size);
    arrow.reach.value = (0.42 * this.reference.size * size) / this.current.largest.angular_momentum;
    arrow.thick.value = 0.0075 * this.reference.size;
  }

  draw() {
    if (!this.scene || this.isDrawing) return;
    this.isDrawing = true;
    requestAnimationFrame(() => {
      this.isDrawing = false;
      this.drawNow();
    });
  }

  drawNow() {
    this.orbit.apply();
    this.scene.draw();
    // Later the canvas of the scene is empty.
    this.film?.add(this.canvas, this.caption(), this.shownField.textContent, this.shownScales);
    this.drawTriad();
    const text = this.describe();
    if (this.foot.textContent !== text) this.foot.textContent = text;
  }

  // What stands in a film.
  caption() {
    return timeText(this.current, this.frames.times[this.shown], 4);
  }

  describe() {
    const { frames, shown, current } = this, { kept, written, notes } = current.frames;
    const factor = Number(this.factor.value);
    this.note.textContent = factor === 1 ? "" : `displacements × ${grouped(factor)}`;
    const thinned = kept < written ? ` (${written} written)` : "";
    return `Frame ${shown + 1} of ${kept}${thinned}, ${stepName(current)} ${frames.steps[shown]}, ${timeText(current, frames.times[shown])}; as computed, without interpolation. ${notes.join(" ")}`;
  }

  drawTriad() {
    const [right, up, towards] = this.orbit.axes();
    const names = ["x", "y", "z"].map((name, i) => ({ name, at: [right[i], -up[i]], depth: towards[i] })).sort((a, b) => a.depth - b.depth);
    const colours = { x: "var(--c1)", y: "var(--c2)", z: "var(--c0)" };
    this.triad.replaceChildren(...names.flatMap(({ name, at: [x, y] }) => [
      element("line", { x1: 0, y1: 0, x2: 18 * x, y2: 18 * y, style: `stroke:${colours[name]}`, "stroke-width": 2, "stroke-linecap": "round" }),
      ...(Math.hypot(x, y) > 0.15 ? [element("text", { x: 25 * x, y: 25 * y, style: `fill:${colours[name]}`, "text-anchor": "middle", "dominant-baseline": "central" }, name)] : [])]));
  }
}

function mapOf(field) {
  return field.signed ? "diverging" : "viridis";
}

// A range that is not empty; around zero for signed quantities.
function usable([low, high], isSigned) {
  const most = Math.max(Math.abs(low), Math.abs(high));
  if (!(low <= high)) return [0, 1];
  if (isSigned && most > 0) return [-most, most];
  return high > low ? [low, high] : [low, low + (Math.abs(low) || 1)];
}

// A factor that makes motions below a hundredth of the body visible: 1, 2 or 5 times a power of ten.
function proposedFactor(largest, size) {
  if (!(largest > 0) || largest > 0.01 * size) return 1;
  const wanted = (0.06 * size) / largest;
  const power = 10 ** Math.floor(Math.log10(wanted));
  return power * (wanted / power >= 5 ? 5 : wanted / power >= 2 ? 2 : 1);
}

function isFlat(frames, box) {
  return box.high[2] - box.low[2] < 1e-9 * box.size;
}
