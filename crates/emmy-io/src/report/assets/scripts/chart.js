// One chart: uPlot with keys that show the values at the time cursor.

const charts = [];
let isZooming = false;

// The same part of the time in all charts.
function zoom(min, max) {
  if (isZooming) return;
  isZooming = true;
  charts.forEach((chart) => chart.plot.setScale("x", { min, max }));
  isZooming = false;
}

function logLabel(value) {
  return `1e${Math.round(Math.log10(value))}`;
}

// Powers of ten, seven of them at most.
function decades(plot, axis, min, max) {
  const [low, high] = [Math.round(Math.log10(min)), Math.round(Math.log10(max))];
  const step = Math.max(1, Math.ceil((high - low) / 6));
  const powers = [];
  for (let power = Math.ceil(low / step) * step; power <= high; power += step) powers.push(10 ** power);
  return powers;
}

function tickLabels(plot, ticks) {
  const largest = Math.max(...ticks.map(Math.abs));
  if (largest >= 1e5 || (largest > 0 && largest < 1e-3)) return ticks.map((tick) => (tick === 0 ? "0" : number(tick, 3)));
  return ticks.map((tick) => number(tick, 6));
}

class Chart {
  // spec: { title, unit, data, first, choices: [{ name, unit, lines: [{ label, colour, dash, width, values, times, stairs }] }], log, range, draw, tools }
  constructor(place, spec, clock) {
    Object.assign(this, { spec, clock });
    this.plotPlace = element("div", { class: "plot", style: `min-height:${spec.height ?? 165}px` });
    this.keys = element("div", { class: "keys" });
    this.unit = element("small");
    const title = element("h3", {}, spec.title, this.unit, spec.note ? element("small", { class: "shaded" }, spec.note) : null);
    const { choices } = spec;
    this.switch = choices.length > 1 ? choiceOf(choices.map(({ name }) => name), (i) => this.choose(i)) : null;
    this.node = element("section", { class: "chart", "aria-label": spec.title },
      element("div", { class: "chart-head" }, title, this.switch?.node ?? null, spec.tools ?? null, this.keys),
      this.plotPlace);
    place.append(this.node);
    this.choose(spec.first ?? 0);
    new ResizeObserver(() => this.resize()).observe(this.plotPlace);
    charts.push(this);
  }

  // Shows one of the choices of lines.
  choose(index) {
    const { unit, lines } = this.spec.choices[index];
    this.switch?.show(index);
    this.lines = lines;
    this.unit.textContent = unit ?? this.spec.unit ?? "";
    this.isOff = lines.map(() => false);
    this.keys.replaceChildren();
    this.values = lines.map((line, i) => this.key(line, i));
    this.build();
    this.show(this.clock.time);
  }

  key(line, i) {
    const value = element("span", { class: "value" });
    if (line.isReading) {
      this.keys.append(element("span", { class: "key" }, line.label, value));
      return value;
    }
    const sample = keySample(i, line.dash ?? [], `var(${line.colour})`, line.width ?? 1.6);
    const key = element("button", { class: "key", type: "button", title: "show or hide", "aria-pressed": String(!this.isOff[i]), onclick: () => {
      this.isOff[i] = !this.isOff[i];
      key.setAttribute("aria-pressed", String(!this.isOff[i]));
      this.plot.setSeries(i + 1, { show: !this.isOff[i] });
    } }, sample, line.label, value);
    this.keys.append(key);
    return value;
  }

  build() {
    const zoomed = this.plot?.scales.x;
    this.plot?.destroy();
    const { spec } = this;
    const lines = this.lines.map((line, i) => ({
      label: line.label, stroke: style(line.colour), width: line.width ?? 1.6, dash: line.dash, show: !this.isOff[i],
      spanGaps: spec.log ?? false, points: { show: line.points ?? false },
      paths: line.stairs ? uPlot.paths.stepped({ align: -1 }) : undefined,
    }));
    const axis = { stroke: style("--muted"), font: "11.5px " + style("--sans"), grid: { stroke: style("--grid"), width: 1 }, ticks: { show: false } };
    const y = { ...axis, size: 62, gap: 6, values: tickLabels, space: 26 };
    if (spec.log) {
      y.splits = decades;
      y.filter = (_, ticks) => ticks;
      y.values = (_, ticks) => ticks.map(logLabel);
    }
    if (spec.whole) y.incrs = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000];
    const x = { ...axis, size: 24, gap: 3, values: tickLabels, space: 70 };
    if (spec.logAbscissa) {
      x.splits = decades;
      x.filter = (_, ticks) => ticks;
      x.values = (_, ticks) => ticks.map((tick) => number(tick));
    }
    const options = {
      ...this.size(), legend: { show: false }, padding: [8, 20, 0, 0],
      scales: { x: { time: false, ...(spec.logAbscissa ? { distr: 3 } : {}) }, y: spec.log ? { distr: 3, range: logRange } : { range: spec.range ?? roomyRange } },
      series: [{}, ...lines], axes: [x, y],
      cursor: { y: false, points: { show: false }, drag: { x: true, y: false, setScale: true }, bind: this.bindings() },
      hooks: {
        drawClear: [(plot) => this.shade(plot)], draw: spec.draw ? [(plot) => spec.draw(plot)] : [],
        setScale: [(plot, scale) => { if (scale === "x") { zoom(plot.scales.x.min, plot.scales.x.max); this.place(); } }],
        setSize: [() => this.place()],
      },
    };
    this.plot = new uPlot(options, spec.data(this.lines), this.plotPlace);
    this.plot.root.append(element("span", { class: "abscissa", "aria-hidden": "true" }, spec.abscissa));
    if (zoomed) this.plot.setScale("x", { min: zoomed.min, max: zoomed.max });
    this.plot.root.querySelector("canvas").setAttribute("aria-hidden", "true");
    this.now = element("div", { class: "now" });
    this.plot.over.append(this.now);
    this.marks = (spec.marks ?? []).map((mark) => ({ mark, node: element("div", { class: "mark", title: mark.title }) }));
    this.marks.forEach(({ node }) => this.plot.over.append(node));
    this.place();
  }

  // Dragging moves the time cursor; with the shift key it chooses a part of the time.
  bindings() {
    const scrub = (plot, target, handler) => (event) => {
      if (event.button !== 0) return;
      if (event.shiftKey) { handler(event); return; }
      const box = plot.over.getBoundingClientRect();
      const move = (event) => this.clock.set(plot.posToVal(event.clientX - box.left, "x"));
      const end = () => { removeEventListener("pointermove", move); removeEventListener("pointerup", end); };
      this.clock.isPlaying = false;
      addEventListener("pointermove", move);
      addEventListener("pointerup", end);
      move(event);
    };
    return { mousedown: scrub, dblclick: () => () => zoom(this.clock.start, this.clock.end) };
  }

  shade(plot) {
    const { ctx, bbox } = plot;
    ctx.fillStyle = style("--shade");
    for (const [from, to] of this.spec.shaded ?? []) {
      const x = (time) => Math.min(Math.max(plot.valToPos(time, "x", true), bbox.left), bbox.left + bbox.width);
      ctx.fillRect(x(from), bbox.top, x(to) - x(from), bbox.height);
    }
  }

  // Puts the cursor and the marks where their times are.
  place() {
    if (!this.plot || !this.now) return;
    const put = (node, time) => {
      const { min, max } = this.plot.scales.x;
      node.hidden = !(time >= min && time <= max);
      node.style.transform = `translateX(${this.plot.valToPos(time, "x")}px)`;
    };
    put(this.now, this.clock.time);
    this.marks.forEach(({ mark, node }) => put(node, mark.time));
  }

  show(time) {
    this.place();
    this.lines.forEach((line, i) => {
      this.values[i].textContent = reading(line.values[lastBefore(line.times, time)]);
    });
  }

  // Size of the plot: its place fills the row of the chart.
  size() {
    const { clientWidth, clientHeight } = this.plotPlace;
    return { width: Math.max(clientWidth, 200), height: Math.max(clientHeight, 100) };
  }

  resize() {
    const { width, height } = this.size();
    if (this.plotPlace.clientWidth > 0 && (width !== this.plot.width || height !== this.plot.height)) this.plot.setSize({ width, height });
  }
}

// Whole decades around the data.
function logRange(plot, min, max) {
  if (!(min > 0) || !(max > 0)) return [1e-16, 1];
  const low = Math.floor(Math.log10(min)), high = Math.ceil(Math.log10(max));
  return [10 ** low, 10 ** Math.max(high, low + 1)];
}

// A margin of a twentieth above and below; a constant is in the middle.
function roomyRange(plot, min, max) {
  if (min === null || max === null) return [0, 1];
  const size = Math.max(Math.abs(min), Math.abs(max));
  const room = max - min > 1e-12 * size ? (max - min) / 20 : (size || 1) / 2;
  return [min - room, max + room];
}
