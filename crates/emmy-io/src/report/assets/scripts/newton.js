// Newton residuals: time to the right, iterations upwards, colour for the residual over its tolerance.

function newtonChart(run, clock) {
  const count = run.array("newton/count");
  const iterations = run.column("newton_iterations");
  if (!count || !count.length) {
    const line = { label: "iterations", values: fromFirstStep(iterations), colour: "--c0", stairs: true };
    return ofRun(run, { title: "Corrections", unit: `of each ${stepName(run)}`, height: 150, whole: true, range: fromZero, lines: [line] });
  }
  const [start, end, residual, target] = ["start", "end", "residual", "target"].map((name) => run.array(`newton/${name}`));
  const first = new Uint32Array(count.length + 1);
  count.forEach((n, i) => { first[i + 1] = first[i] + n; });
  const excess = (i, k) => Math.log10(residual[first[i] + k] / target[i]);
  let most = 1, largest = 1;
  for (let i = 0; i < count.length; i++) {
    most = Math.max(most, count[i]);
    for (let k = 0; k < count[i]; k++) if (Number.isFinite(excess(i, k))) largest = Math.max(largest, excess(i, k));
  }
  const colours = colourMap("viridis");
  const colour = (value) => {
    const at = 3 * Math.round(255 * Math.min(Math.max(Number.isNaN(value) ? 1 : value / largest, 0), 1));
    return `rgb(${colours[at]},${colours[at + 1]},${colours[at + 2]})`;
  };
  // Steps that share a pixel show the largest residual.
  const draw = (plot) => {
    const { ctx, bbox } = plot;
    ctx.save();
    ctx.beginPath();
    ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
    ctx.clip();
    const y = (k) => plot.valToPos(k, "y", true);
    const height = y(0) - y(1), gap = height > 6 ? 1 : 0;
    const cell = (left, right, worst) => worst.forEach((value, k) => {
      ctx.fillStyle = colour(value);
      ctx.fillRect(left, y(k + 1) + gap, right - left, height - gap);
    });
    let column = null;
    for (let i = 0; i < count.length; i++) {
      const left = plot.valToPos(start[i], "x", true), right = plot.valToPos(end[i], "x", true);
      if (right < bbox.left || left > bbox.left + bbox.width) continue;
      if (column && left < column.left + 1) column.right = Math.max(right, column.left + 1);
      else {
        if (column) cell(column.left, column.right, column.worst);
        column = { left, right: Math.max(right - (right - left > 4 ? 1 : 0), left + 1), worst: [] };
      }
      for (let k = 0; k < count[i]; k++) column.worst[k] = Math.max(column.worst[k] ?? -Infinity, excess(i, k));
    }
    if (column) cell(column.left, column.right, column.worst);
    ctx.restore();
  };
  const map = element("canvas", { "aria-hidden": "true" });
  drawMap(map, "viridis");
  const ramp = element("span", { class: "ramp" }, "at the tolerance", map, `1e${Math.round(largest)} times the tolerance`);
  const last = Array.from(count, (n, i) => (n ? residual[first[i] + n - 1] : null));
  const line = (label, times, values) => ({ label, times, values, colour: "--muted", width: 0, isReading: true });
  const nothing = () => new Array(run.time.length).fill(null);
  return ofRun(run, { title: "Newton residuals", unit: "one cell an evaluation, upwards", height: 150, whole: true, tools: ramp, draw,
    range: () => [0, most], lines: [line("iterations", run.time, iterations), line("last residual", end, last)],
    data: () => [run.time, nothing(), nothing()] });
}
