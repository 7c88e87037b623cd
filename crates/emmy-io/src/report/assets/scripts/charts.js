// The charts of the page, for one run and for several.

const AXES = [["x", "--c1", []], ["y", "--c2", [6, 3]], ["z", "--c0", [2, 3]]];

function showCharts(place, runs, clock) {
  const specs = runs.length === 1 ? chartsOfRun(runs[0], clock) : chartsOfRuns(runs, clock);
  specs.forEach((spec) => new Chart(place, spec, clock));
  clock.follow((time) => charts.forEach((chart) => chart.show(time)));
  isDark.addEventListener("change", () => charts.forEach((chart) => chart.build()));
}

// Lines of one run over its own times.
function ofRun(run, { lines, choices = [{ lines }], ...spec }) {
  const timed = choices.map((choice) => ({ ...choice, lines: choice.lines.map((line) => ({ times: run.time, ...line })) }));
  const data = (lines) => [run.time, ...lines.map((line) => line.values)];
  return { abscissa: abscissaOf(run), shaded: run.shaded, marks: run.marks, data, ...spec, choices: timed };
}

// Lines of several runs over the times of all of them.
function ofRuns({ lines, choices = [{ lines }], ...spec }) {
  const data = (lines) => uPlot.join(lines.map((line) => [line.times, line.values]));
  return { abscissa: abscissaOf(manifest.runs[0]), data, ...spec, choices };
}

// The quantity on the horizontal axes.
function abscissaOf(run) {
  return isStatic(run) ? "fraction" : inUnit("t", unitOf(run, "time"));
}

function chartsOfRun(run, clock) {
  if (isStatic(run)) return chartsOfAnalysis(run, clock);
  const column = run.column;
  const line = (label, values, colour, dash, width) => ({ label, values, colour, dash, width });
  const vector = (name, letter) => [
    ...AXES.map(([axis, colour, dash]) => line(`${letter}${axis}`, column(`${name}_${axis}`), colour, dash)),
    line(`|${letter}|`, run.norm(name), "--ink", [], 2)];
  const specs = [
    ofRun(run, { title: "Energies", unit: inUnit("", unitOf(run, "total_energy")), note: run.loadNote, height: 190, lines: [
      line("T kinetic", column("kinetic_energy"), "--c0", [6, 3]), line("V strain", column("strain_energy"), "--c1", [2, 3]),
      ...(column("contact_energy") ? [line("V_c contact", column("contact_energy"), "--c4", [4, 2])] : []),
      line(`H = ${energies(run)}`, column("total_energy"), "--ink", [], 2.2), line("W external", column("external_work"), "--c2", [9, 3, 2, 3]),
      ...(column("dissipated_energy") ? [line("D dissipated", column("dissipated_energy"), "--c3", [2, 2])] : [])] }),
    residuals(run),
    ...constraints(run),
    ...chartsOfQuantities(run),
    ofRun(run, { title: "Angular momentum", unit: inUnit("about the origin" + ifRounding(run, "angular_momentum"), unitOf(run, "angular_momentum_x")), lines: vector("angular_momentum", "L") }),
    ofRun(run, { title: "Linear momentum", unit: inUnit(ifRounding(run, "linear_momentum"), unitOf(run, "linear_momentum_x")), lines: vector("linear_momentum", "P") }),
    newtonChart(run, clock),
    stepSizes(run),
  ];
  const error = column("local_error");
  if (error) {
    specs.push(ofRun(run, { title: "Error of each step", unit: "estimated, relative to the scales of the input", log: true, height: 150,
      lines: [line("local error", sizes(error, 1), "--c0")] }));
  }
  return [...specs, ...determinants(run)];
}

// Charts of a static analysis: nothing moves, so that there are no balances over time.
function chartsOfAnalysis(run, clock) {
  const line = (label, name, colour, dash) => ({ label, values: run.column(name), colour, dash });
  return [
    ofRun(run, { title: "Stored energy", unit: inUnit("", unitOf(run, "strain_energy")), height: 190, lines: [line("V", "strain_energy", "--ink", [])] }),
    ...chartsOfQuantities(run),
    ofRun(run, { title: "Resultant of loads and reactions", log: true, choices: [
      { name: "force", unit: inUnit("", unitOf(run, "linear_momentum_residual")), lines: [{ ...line("|R|", "linear_momentum_residual", "--c2"), values: sizes(run.column("linear_momentum_residual"), 1) }] },
      { name: "moment", unit: inUnit("about the origin", unitOf(run, "angular_momentum_residual")), lines: [{ ...line("|M|", "angular_momentum_residual", "--c1"), values: sizes(run.column("angular_momentum_residual"), 1) }] }] }),
    newtonChart(run, clock),
    stepSizes(run),
    ...determinants(run)];
}

function stepSizes(run) {
  const values = fromFirstStep(run.column("step_size"));
  return ofRun(run, { title: isStatic(run) ? "Size of the increments" : "Step size", unit: inUnit("", unitOf(run, "step_size")), height: 150, range: fromZero,
    lines: [{ label: "h", values, colour: "--c0", stairs: true }] });
}

function determinants(run) {
  const values = run.column("smallest_determinant");
  if (!values?.some(Number.isFinite)) return [];
  return [ofRun(run, { title: "Smallest det F", unit: "over all quadrature points; 1: volume unchanged", height: 150,
    lines: [{ label: "min det F", values: nulled(values), colour: "--c0" }] })];
}

// A momentum of round-off only would fill a scale of its own.
function ifRounding(run, key) {
  return isRounding(run, key) ? " nothing but rounding" : "";
}

// The residuals of a step, as parts of the largest value of their quantity.
function residuals(run) {
  const colours = { energy: ["--ink", [], 1.7], linear_momentum: ["--c2", [6, 3], 1.4], angular_momentum: ["--c1", [2, 3], 1.7] };
  const labels = { energy: "energy", linear_momentum: "linear mom.", angular_momentum: "angular mom." };
  const lines = balances(run).map(({ key, size }) => {
    const [colour, dash, width] = colours[key];
    return { label: labels[key], values: sizes(run.column(`${key}_residual`), size), colour, dash, width };
  });
  return ofRun(run, { title: "Balance of each step", unit: `residual, as a part of the largest ${energies(run)}, |P|, |L|`, log: true, height: 190, lines });
}

// How well joints and rigid bodies kept their shape.
function constraints(run) {
  const [opening, rate] = ["constraint_residual", "hidden_constraint"].map(run.column);
  if (!opening) return [];
  const choice = (name, unit, values, colour, others = []) =>
    ({ name, unit, lines: [{ label: name, values: sizes(values, 1), colour }, ...others] });
  // Roundings of the steps add up at most like their number.
  const { constraint_rounding: most, steps } = run.summary ?? {};
  const rounding = most > 0 && steps > 0
    ? [{ label: "rounding", values: Array.from(opening, (_, i) => (i === 0 ? null : (most * i) / steps)), colour: "--c2", dash: [2, 3] }]
    : [];
  return [ofRun(run, { title: "Constraints", log: true, height: 150, choices: [
    choice("opening", "largest one of a joint, as a part of the size of the whole", opening, "--ink", rounding),
    choice("rate", inUnit("of the largest opening", unitOf(run, "hidden_constraint")), rate, "--c2")] })];
}

// Absolute residuals as parts of a scale; exact zeros and the start are left out, as they have no logarithm.
function sizes(values, size) {
  return Array.from(values, (value, i) => (i === 0 || value === 0 || !Number.isFinite(value) ? null : Math.abs(value) / (size || 1)));
}

function nulled(values) {
  return Array.from(values, (value) => (Number.isFinite(value) ? value : null));
}

// Quantities of steps: the start takes the value of the first step.
function fromFirstStep(values) {
  const all = Array.from(values);
  if (all.length > 1) all[0] = all[1];
  return all;
}

function fromZero(plot, min, max) {
  return [0, max > 0 ? 1.12 * max : 1];
}

function chartsOfRuns(runs, clock) {
  const each = (values) => runs.map((run) => ({
    label: run.name, times: run.time, values: values(run), colour: `--c${run.index % 8}`, dash: DASHES[run.index % DASHES.length],
  }));
  const residual = (key, title, unit) => {
    const values = (run) => sizes(run.column(`${key}_residual`), balances(run).find((balance) => balance.key === key).size);
    return ofRuns({ title, unit, log: true, height: 190, lines: each(values) });
  };
  const column = (name) => each((run) => run.column(name));
  const stairs = (name) => each((run) => fromFirstStep(run.column(name))).map((line) => ({ ...line, stairs: true }));
  const unit = (name, column) => inUnit(name, unitOf(runs[0], column));
  const specs = [
    ofRuns({ title: "Total energy", unit: unit(energies(...runs), "total_energy"), height: 190, lines: column("total_energy") }),
    residual("energy", "Energy balance of each step", `residual, as a part of the largest ${energies(...runs)}`),
    ...comparedQuantities(runs, each),
    ofRuns({ title: "Angular momentum", unit: unit("|L| about the origin", "angular_momentum_x"), height: 190, lines: each((run) => run.norm("angular_momentum")) }),
    residual("angular_momentum", "Angular momentum balance of each step", "residual, as a part of the largest |L|"),
    ofRuns({ title: "Linear momentum", unit: unit("|P|", "linear_momentum_x"), lines: each((run) => run.norm("linear_momentum")) }),
    residual("linear_momentum", "Linear momentum balance of each step", "residual, as a part of the largest |P|"),
    ofRuns({ title: "Kinetic energy", unit: unit("T", "kinetic_energy"), lines: column("kinetic_energy") }),
    ofRuns({ title: "Strain energy", unit: unit("V", "strain_energy"), lines: column("strain_energy") }),
    ofRuns({ title: "Corrections", unit: "of each step", whole: true, range: fromZero, lines: stairs("newton_iterations") }),
    ofRuns({ title: "Step size", unit: unit("", "step_size"), range: fromZero, lines: stairs("step_size") }),
  ];
  const errors = each((run) => run.column("local_error")).filter((line) => line.values);
  if (errors.length) {
    specs.push(ofRuns({ title: "Error of each step", unit: "estimated", log: true,
      lines: errors.map((line) => ({ ...line, values: sizes(line.values, 1) })) }));
  }
  if (runs.every((run) => run.column("smallest_determinant")?.some(Number.isFinite))) {
    specs.push(ofRuns({ title: "Smallest det F", lines: each((run) => nulled(run.column("smallest_determinant"))) }));
  }
  return specs;
}
