// The verdict: how well a run conserved energy and momenta.

// A balance closes if its residual is at most this part of the quantity, in one step and accumulated over the run.
const CLOSED = { step: 1e-11, run: 1e-9 };
// A balance does not close if its accumulated residual exceeds this part.
const DRIFT = 1e-4;

const SIGNS = {
  good: ["M1 8 l5 5 L15 2", "closes to 11 digits"],
  fair: ["M1 10 q3.5 -7 7 -3 t7 -3", "closes to 4 digits"],
  poor: ["M8 1 L15 14 H1 Z", "does not close"],
};

// A body at rest, or without rotation, has a momentum of round-off only, which is no scale for a residual.
function isRounding(run, key) {
  const scale = run.summary[`${key}_scale`];
  return scale > 0 && run.largest[key] < 1e-9 * scale;
}

// The energies of a motion, with that of contact if some run has contact; their sum is the total energy.
function energies(...runs) {
  return runs.some((run) => run.summary?.largest_contact_energy !== undefined) ? "T + V + V_c" : "T + V";
}

function unbroken(text) {
  return text.replaceAll(" ", "\u00a0");
}

// A mechanism at rest has an energy of round-off, although its joints carry loads.
function energyScale(run) {
  const { largest_energy: largest, energy_scale: scale } = run.summary;
  const sum = unbroken(energies(run));
  return largest < 1e-24 * scale ? [scale, `the work of a joint over the size of the mechanism, ${sum} being zero`] : [largest, `the largest ${sum}`];
}

// The three balances of a run with their scales.
function balances(run) {
  const summary = run.summary;
  const momentum = (key, letter) => {
    const largest = run.largest[key];
    const scale = summary[`${key}_scale`];
    if (scale === undefined && largest < 10 * summary[`worst_${key}_residual`]) return [NaN, null];
    const bound = unbroken(`√(2 (${energies(run)}) ${key === "angular_momentum" ? "I" : "m"})`);
    return isRounding(run, key) ? [scale, `${bound}, ${letter} being zero`] : [largest, `the largest |${letter}|`];
  };
  const balance = (name, key, [size, of], drift) => {
    const worst = summary[`worst_${key}_residual`];
    const part = worst === 0 ? 0 : worst / size;
    return { name, key, worst, step: summary[`worst_${key}_residual_step`], size, of, part, drift };
  };
  return [
    balance("Energy", "energy", energyScale(run), summary.energy_drift),
    balance("Linear momentum", "linear_momentum", momentum("linear_momentum", "P"), null),
    balance("Angular momentum", "angular_momentum", momentum("angular_momentum", "L"), summary.angular_momentum_drift),
  ];
}

function grade({ part, drift, of }) {
  if (of === null) return "fair";
  const sum = drift ?? part;
  if (part === null || Number.isNaN(part) || drift === undefined) return "poor";
  if (part <= CLOSED.step && sum <= CLOSED.run) return "good";
  return Math.max(part, sum) <= DRIFT ? "fair" : "poor";
}

function sign(mark) {
  return element("svg", { class: "sign", viewBox: "0 0 16 16", width: 13, height: 13, "aria-hidden": "true" },
    element("path", { d: SIGNS[mark][0], fill: "none", stroke: "currentColor", "stroke-width": "2.6", "stroke-linejoin": "round", "stroke-linecap": "round" }));
}

function balanceCard(run, balance) {
  const mark = grade(balance);
  const { key, part, of, step, drift } = balance;
  const unit = unitOf(run, key === "energy" ? "energy_residual" : `${key}_residual`);
  const rest = element("p", { class: "rest" }, "largest residual of a step ", ofSummary(run, `worst_${key}_residual`), unit && ` ${unit}`);
  if (step > 0) rest.append(", in step ", ofSummary(run, `worst_${key}_residual_step`, String(step)));
  if (drift !== null && drift !== undefined) {
    rest.append("; accumulated ", ofSummary(run, key === "energy" ? "energy_drift" : "angular_momentum_drift", number(drift, 2)));
  }
  return element("div", { class: "balance" },
    element("h2", {}, `${balance.name} balance`),
    element("p", { class: `word ${mark}` }, sign(mark), of === null ? "has no scale" : SIGNS[mark][1]),
    of === null ? null : element("p", { class: "part" }, element("b", { class: "num", "data-part": key }, number(part, 2)), ` of ${of}`),
    rest);
}

// Loads and reactions of a static analysis are in balance.
function equilibriumCard(run) {
  const part = (name, key) => [`${name} `, ofSummary(run, `worst_${key}_residual`), unitOf(run, `${key}_residual`) && ` ${unitOf(run, `${key}_residual`)}`];
  return element("div", { class: "balance" }, element("h2", {}, "Resultant of loads and reactions"),
    element("p", { class: "part" }, ...part("largest force", "linear_momentum"), element("br"), ...part("largest moment", "angular_momentum")));
}

// What limited the sizes of adaptive steps, the most frequent first.
function stepLimits(summary) {
  const counts = Object.entries(summary).filter(([key]) => key.startsWith("step_limits_")).sort((a, b) => b[1] - a[1]);
  const all = counts.reduce((sum, [, count]) => sum + count, 0);
  return counts.map(([key, count]) => `${key.slice("step_limits_".length).replace("_", " ")} ${Math.round(100 * count / all)} %`).join(", ");
}

// How well the steps resolve the motion, which no balance tells.
function accuracyCard(run) {
  const { accuracy_in_time: kind, accuracy_in_time_text: text } = run.summary;
  if (!kind) return null;
  const mark = { estimated: "good", coarse: "poor" }[kind] ?? "fair";
  return element("div", { class: "balance accuracy" }, element("h2", {}, "Accuracy in time"),
    element("p", { class: `word ${mark}` }, sign(mark), kind),
    element("p", { class: "rest" }, text.slice(kind.length).replace(/^[:;,]? /, "").replaceAll("`", "")));
}

// Size and cost of a run, as words that wrap.
function facts(run) {
  const s = run.summary;
  const fact = (term, ...value) => element("div", {}, element("dt", {}, term), " ", element("dd", {}, ...value));
  const small = (text) => element("small", {}, text);
  const mean = s.steps > 0 ? `, ${(s.newton_iterations / s.steps).toFixed(1)} per ${stepName(run)}` : "";
  return element("dl", { class: "facts" },
    fact("scheme", ofSummary(run, "scheme", s.scheme), isStatic(run) ? null : small(`, degree ${s.degree}`)),
    fact(`${stepName(run)}s`, ofSummary(run, "steps", grouped(s.steps)), small(` to ${timeText(run, s.time)}`)),
    stepLimits(s) ? fact("step size limited by", small(stepLimits(s))) : null,
    fact("corrections", ofSummary(run, "newton_iterations", grouped(s.newton_iterations)), small(mean)),
    fact("dofs", ofSummary(run, "dofs", grouped(s.dofs))),
    fact("cells", ofSummary(run, "cells", grouped(s.cells)), small(`, ${grouped(s.nodes)} nodes`)),
    fact("time", ofSummary(run, "wall_seconds", duration(s.wall_seconds))));
}

// The largest values of the run, displacement first, with those of each region; a click shows their time.
function extremes(run, clock) {
  const names = Object.keys(run.summary).map((key) => key.match(/^largest_(.+)_point$/)?.[1]).filter((name) => run.summary[`largest_${name}`] > 0);
  return names.length ? element("div", { class: "balance extremes" }, ...names.map((name) => extreme(run, name, clock))) : null;
}

function extreme(run, name, clock) {
  const key = `largest_${name}`, s = run.summary;
  const quantity = name.replace("relative_", "");
  const [unit, length, time] = [quantity, "displacement", "time"].map((name) => unitOf(run, name)).map((unit) => unit && ` ${unit}`);
  const show = (at, ...text) => element("button", { class: "link", type: "button", title: "show this time", onclick: () => clock.set(at) },
    isStatic(run) ? "load fraction = " : "t = ", ...text, time);
  const place = (point) => `, at (${point.map((x) => number(x)).join(", ")})${length}`;
  const regions = (s.largest_in_regions ?? []).filter((row) => row.field === name);
  const row = (own) => element("p", { class: "rest", "data-region": own.region }, `in ${own.region}: ${number(own.value)}`, unit, ", ",
    show(own.time, number(own.time)), place(own.point));
  return element("div", {}, element("h2", {}, `Largest ${words(quantity)}`, name === "displacement" ? "" : relation(run, quantity)),
    element("p", { class: "size" }, ofSummary(run, key), unit),
    element("p", { class: "rest" }, show(s[`${key}_time`], ofSummary(run, `${key}_time`)), place(s[`${key}_point`])),
    ...regions.map(row));
}

// Warnings that limit the verdict.
function warnings(run) {
  const { digits_left: digits, unresolved_loads: missed, steps, smallest_gap: gap } = run.summary;
  const note = (...text) => element("p", { class: "note" }, "Warning: ", ...text);
  const notes = (run.summary.notes ?? []).map((text) => element("p", { class: "note" }, "Note: ", text.replaceAll("`", "")));
  return [
    digits < 6 ? note("rounding leaves ", ofSummary(run, "digits_left", String(digits)), " correct digits of energy and momenta.") : null,
    missed > 0 ? note(ofSummary(run, "unresolved_loads", grouped(missed)), ` of ${grouped(steps)} steps did not resolve a load or a given motion.`) : null,
    typeof gap === "number" && gap < 0.05 ? note("the layer is too soft for this impact: a gap is down to ", ofSummary(run, "smallest_gap", number(gap)), " of its thickness.") : null,
    ...notes,
  ].filter((warning) => warning !== null);
}

function showVerdict(place, runs, clock) {
  if (runs.length === 1) {
    const [run] = runs;
    const cards = isStatic(run) ? [equilibriumCard(run)] : balances(run).map((b) => balanceCard(run, b));
    place.append(facts(run), element("div", { class: "strip" }, ...cards, accuracyCard(run), extremes(run, clock)), ...warnings(run));
    return;
  }
  const heads = ["run", "scheme", "energy", "linear momentum", "angular momentum", "accuracy in time", "steps", "Newton", "dofs", "time", "status"];
  const cell = (run, balance) => {
    const mark = grade(balance);
    const word = `${balance.name} balance ${SIGNS[mark][1]}`;
    return element("td", {}, element("span", { class: mark, role: "img", "aria-label": word, title: word }, sign(mark)), " ",
      element("b", { class: "num", "data-part": balance.key, "data-run": run.name }, balance.of === null ? "–" : number(balance.part, 2)), " ",
      element("small", {}, "step ", ofSummary(run, `worst_${balance.key}_residual_step`, String(balance.step))));
  };
  const row = (run) => element("tr", {},
    element("th", { scope: "row" }, keySample(run.index), " ", run.files.includes("report.html") ? element("a", { href: linkTo(run.href, "report.html") }, run.name) : run.name),
    element("td", {}, ofSummary(run, "scheme", run.summary.scheme), run.summary.degree > 1 ? `, degree ${run.summary.degree}` : ""),
    ...balances(run).map((balance) => cell(run, balance)),
    element("td", { title: run.summary.accuracy_in_time_text ?? "" }, run.summary.accuracy_in_time ?? "–"),
    element("td", {}, ofSummary(run, "steps", grouped(run.summary.steps))),
    element("td", {}, ofSummary(run, "newton_iterations", grouped(run.summary.newton_iterations))),
    element("td", {}, ofSummary(run, "dofs", grouped(run.summary.dofs))),
    element("td", {}, ofSummary(run, "wall_seconds", duration(run.summary.wall_seconds))),
    element("td", {}, run.summary.status));
  place.append(element("div", { class: "table-wrap" }, element("table", { class: "runs" },
    element("thead", {}, element("tr", {}, ...heads.map((head) => element("th", { scope: "col" }, head)))),
    element("tbody", {}, ...runs.map(row)))),
    element("p", { class: "note" }, `Balances: the largest residual of a step as a part of the largest ${energies(...runs)}, |P|, |L| of the run. `,
      ...["good", "fair", "poor"].flatMap((mark) => [element("span", { class: mark }, sign(mark)), ` ${SIGNS[mark][1]}  `])));
}
