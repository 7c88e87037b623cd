// Charts of the columns that depend on the input: probes, reactions, joints, rigid bodies, extremes and values of groups.

// Columns with charts of their own, or without one.
const STANDARD = new Set(["step", "time", "step_size", "kinetic_energy", "strain_energy", "external_work", "total_energy", "energy_residual",
  "linear_momentum_residual", "angular_momentum_residual", "newton_iterations", "wall_seconds", "smallest_determinant", "local_error", "limited_by", "dissipated_energy", "degree", "contact_energy", "smallest_gap", "contact_points", "constraint_residual", "hidden_constraint",
  ...["linear", "angular"].flatMap((kind) => ["x", "y", "z"].map((axis) => `${kind}_momentum_${axis}`))]);

const COMPONENTS = { x: ["--c1", []], y: ["--c2", [6, 3]], z: ["--c0", [2, 3]],
  xx: ["--c1", []], yy: ["--c2", [6, 3]], zz: ["--c0", [2, 3]], xy: ["--c3", [9, 3]], yz: ["--c5", [4, 4]], xz: ["--c6", [2, 2]],
  1: ["--c1", []], 2: ["--c2", [6, 3]], 3: ["--c0", [2, 3]] };

const LETTERS = { position: "", displacement: "u", velocity: "v", acceleration: "a", force: "F", moment: "M", spin: "ω", cauchy_stress: "σ", second_piola_kirchhoff_stress: "S", green_lagrange_strain: "E" };

function words(name) {
  return name.replaceAll("_", " ").replace("von mises", "von Mises").replace("cauchy", "Cauchy").replace("green lagrange", "Green-Lagrange").replace("piola kirchhoff", "Piola-Kirchhoff");
}

// Quantities with the columns of their components: `foot_force_x, _y, _z` are the components x, y and z of `foot_force`.
function quantities(run) {
  const found = new Map();
  for (const column of run.history.columns.filter((name) => !STANDARD.has(name))) {
    const [, stem, component] = column.match(/^(.+)_(x|y|z|xx|yy|zz|xy|yz|xz|[123])$/) ?? [null, column, ""];
    if (!found.has(stem)) found.set(stem, []);
    found.get(stem).push({ column, component });
  }
  return [...found].map(([stem, parts]) => ({ stem, parts, ...meaning(run, stem, parts) }));
}

// What a quantity is, by its name: `owner` and `name` of the quantity. No probe has a force or a moment.
function meaning(run, stem, [{ component }]) {
  if (run.values.includes(stem)) return { title: stem, name: stem };
  const joint = named(run.joints, stem, ({ name }) => name, JOINT);
  if (joint !== undefined) return { title: `Joint ${joint.name}`, joint, name: stem.slice(joint.name.length + 1), unit: "mean of a step" };
  const body = component === "x" ? named(run.rigid, stem, (name) => name, /^(spin)?$/) : undefined;
  if (body !== undefined) return { title: `Rigid body ${body}`, owner: body, name: stem.slice(body.length + 1) || "position" };
  const [, group, name] = stem.match(/^(.+)_(force|moment)$/) ?? [];
  if (group && component === "x") return { title: `Reaction ${name} of ${group}`, name, unit: name === "moment" ? "about the origin" : isStatic(run) ? "" : "mean of a step" };
  const probe = run.probes.filter((name) => stem === name || stem.startsWith(`${name}_`)).sort((a, b) => b.length - a.length)[0];
  if (probe !== undefined) return { title: `Probe ${probe}`, owner: probe, name: stem.slice(probe.length + 1) || "position" };
  if (stem.startsWith("max_")) return { title: `${stem.startsWith("max_largest") ? "" : "Largest "}${words(stem.slice(4))}${relation(run, stem.slice(4))}`, name: stem, unit: "over the body" };
  return { title: stem, name: stem };
}

// Quantities of joints after their names.
const JOINT = /^(force|moment|angle|slide|distance|torque|drive_force)$/;

// The one of some objects whose name, with a word after it, is that of a quantity; of several the one with the longest name.
function named(all, stem, nameOf, word) {
  const fits = (name) => (stem === name && word.test("")) || (stem.startsWith(`${name}_`) && word.test(stem.slice(name.length + 1)));
  return all.filter((own) => fits(nameOf(own))).sort((a, b) => nameOf(b).length - nameOf(a).length)[0];
}

// Joints at a point, whose moment about it is nothing but rounding.
const WITHOUT_MOMENT = new Set(["spherical", "inline", "distance", "line"]);

// The force and the moment of a joint; its coordinate and the torque or force of its drive.
function chartsOfJoint(run, own) {
  const { joint } = own[0];
  const choices = (names) => names.flatMap((name) => own.filter((quantity) => quantity.name === name)).map((quantity) => ({
    name: words(quantity.name), unit: inUnit(quantity.name === "moment" ? "about the joint" : "", quantity.name === "angle" ? "rad" : unitOf(run, quantity.parts[0].column)), lines: linesOf(run, quantity) }));
  const forces = choices(WITHOUT_MOMENT.has(joint.kind) ? ["force"] : ["force", "moment"]);
  const coordinates = choices(["angle", "slide", "distance", "torque", "drive_force"]);
  const chart = (what, choices) => ofRun(run, { title: `Joint ${joint.name}: ${what}`, height: 150, choices });
  return [chart(`${forces.map(({ name }) => name).join(" and ")} on its first body`, forces),
    ...(coordinates.length ? [chart(coordinates.map(({ name }) => name).join(" and "), coordinates)] : [])];
}

// One chart for each quantity of a run, two for a joint. A probe's position is shown as displacement; the position itself would only show
// where the node is.
function chartsOfQuantities(run) {
  const all = quantities(run);
  const find = (owner, name) => all.find((quantity) => quantity.owner === owner && quantity.name === name);
  return all.filter(({ owner, name }) => !(name === "displacement" && owner !== undefined && find(owner, "position"))).flatMap((quantity) => {
    const { joint } = quantity;
    if (joint) return quantity.name === "force" ? chartsOfJoint(run, all.filter((own) => own.joint === joint)) : [];
    const lines = linesOf(run, quantity);
    const { title, unit, owner, name } = quantity;
    if (name !== "position" || owner === undefined) {
      const what = owner === undefined ? unit : words(name) + relation(run, name, owner);
      return ofRun(run, { title, unit: inUnit(what, unitOf(run, quantity.parts[0].column)), height: 150, lines });
    }
    const own = find(owner, "displacement");
    const from = lines.map(({ values }) => number(values[0]));
    const symbol = unitOf(run, quantity.parts[0].column);
    const moved = own ? linesOf(run, own)
      : lines.map((line, i) => ({ ...line, label: `u${quantity.parts[i].component}`, values: line.values.map((value) => (value === null ? null : value - line.values[0])) }));
    return ofRun(run, { title, height: 150, choices: [
      { name: "displacement", unit: inUnit(`from (${from.join(", ")})${relation(run, "displacement", owner)}`, symbol), lines: moved },
      { name: "position", unit: inUnit(relation(run, "position", owner).trim(), symbol), lines }] });
  });
}

function linesOf(run, { parts, owner, name }) {
  const letter = LETTERS[name] ?? "";
  const lines = parts.map(({ column, component }) => {
    const [colour, dash] = COMPONENTS[component] ?? ["--c0", []];
    return { label: component ? letter + component : owner === undefined ? name : words(name), values: nulled(run.column(column)), colour, dash };
  });
  if (parts.length === 3 && (name === "force" || name === "moment")) {
    const norm = lines[0].values.map((x, i) => (x === null ? null : Math.hypot(x, lines[1].values[i], lines[2].values[i])));
    lines.push({ label: `|${letter}|`, values: norm, colour: "--ink", dash: [], width: 2 });
  }
  return lines;
}

// Largest difference of two numbers.
function rangeOf(values) {
  const numbers = values.filter((value) => value !== null);
  return numbers.length ? numbers.reduce((most, value) => Math.max(most, value), -Infinity) - numbers.reduce((least, value) => Math.min(least, value), Infinity) : 0;
}

// Charts of the quantities that all of several runs have, one component at a time, that of the largest range first.
function comparedQuantities(runs, each) {
  const others = runs.slice(1).map((run) => new Set(run.history.columns));
  const isShared = ({ parts }) => others.every((columns) => parts.every(({ column }) => columns.has(column)));
  return quantities(runs[0]).filter(isShared).map(({ title, unit, owner, joint, name, parts }) => {
    const what = inUnit(owner === undefined && joint === undefined ? unit : words(name) + relation(runs[0], name, owner), unitOf(runs[0], parts[0].column));
    const choices = parts.map(({ column, component }) => ({ name: component, unit: what, lines: each((run) => nulled(run.column(column))) }));
    const ranges = choices.map(({ lines }) => Math.max(...lines.map(({ values }) => rangeOf(values))));
    const first = ranges.indexOf(Math.max(...ranges));
    return ofRuns({ title, height: 150, ...(choices.length > 1 ? { choices, first: Math.max(first, 0) } : choices[0]) });
  });
}
