// Heading, events, input, links, and the foot of the page.

function showHeading(runs) {
  const id = (name) => document.getElementById(name);
  const [run] = runs, { summary } = run;
  if (runs.length > 1) {
    id("title").textContent = runs.map((run) => run.name).join(", ");
    id("subtitle").textContent = `${runs.length} runs side by side`;
    return;
  }
  id("title").textContent = summary.title ?? run.name;
  id("subtitle").textContent = `${run.name}, computed by Emmy ${summary.version}`;
  id("status").append(...statusText(summary));
}

function statusText(summary) {
  const steps = `${stepName({ summary })}${(summary.planned_steps ?? summary.steps) === 1 ? "" : "s"}`;
  const strong = (text, mark = "") => element("strong", { class: mark }, text);
  switch (summary.status) {
    case "done": return [strong("Done"), `: ${grouped(summary.steps)} ${steps} in `, duration(summary.wall_seconds)];
    case "running": return [strong("Running"), `: ${grouped(summary.steps)}${summary.planned_steps === null ? "" : ` of ${grouped(summary.planned_steps)}`} ${steps} when this page was written; reload it for more`];
    default: return [strong(summary.status.replaceAll("-", " "), "poor"), `: ${summary.message ?? `after ${summary.steps} ${steps}`}`];
  }
}

function showDetails(place, runs, differences) {
  if (runs.length === 1) {
    const [run] = runs;
    if (run.events.length) place.append(eventTable(run));
    place.append(element("section", { class: "card" }, element("h2", {}, "Data"), fileList(run)));
    place.append(inputText(run, "Input, with all defaults"));
    return;
  }
  showDifferences(place, runs, differences);
  runs.forEach((run) => place.append(inputText(run, `Input of ${run.name}`)));
}

const FILES = {
  "history.csv": "one row a step, 17 digits", "columns.json": "the columns of history.csv with their units", "newton.csv": "residuals of the Newton iteration", "events.csv": "cuts, rejections, releases and other events",
  "summary.json": "the verdict", "input.toml": "the input", "report.html": "the report",
  "modes.csv": "frequencies, periods and effective masses, 17 digits", "modes.toml": "the input",
  "spectrum.csv": "all columns, 17 digits", "spectrum.svg": "the charts", "response.csv": "amplitudes and phases, 17 digits", "response_modes.csv": "the modes with their damping", "response.svg": "the charts", "response.toml": "the input",
};

function fileList(run) {
  const item = (file) => element("li", {}, element("a", { href: linkTo(run.href, file) }, file), " ",
    element("small", {}, FILES[file] ?? (file.endsWith(".pvd") ? "the motion, for ParaView or PyVista" : "")));
  return element("ul", { class: "files" }, ...run.files.map(item));
}

function linkTo(href, file) {
  return (href.startsWith("file:") ? encodeURI(href) : href.split("/").map(encodeURIComponent).join("/")) + encodeURIComponent(file);
}

// Keys in which the inputs differ, and peaks of columns with their differences from the first run.
function showDifferences(place, runs, { inputs, peaks }) {
  const names = runs.map((run) => run.name);
  const table = (title, note, heads, rows) => element("section", { class: "card" }, element("h2", {}, title), note ? element("p", { class: "note" }, note) : null,
    element("div", { class: "table-wrap" }, element("table", { class: "runs differences", "aria-label": title },
      element("thead", {}, element("tr", {}, ...heads.map((head) => element("th", { scope: "col" }, head)))),
      element("tbody", {}, ...rows.map(([head, ...cells]) => element("tr", {}, element("th", { scope: "row" }, head), ...cells.map((cell) => element("td", {}, cell))))))));
  const percent = (part) => (part === null ? "–" : `${part < 0 ? "" : "+"}${(100 * part).toFixed(2)} %`);
  if (inputs.length) {
    place.append(table("Inputs that differ", null, ["key", ...names], inputs.map(({ key, values }) => [key, ...values.map((value) => value ?? "–")])));
  }
  if (peaks.length) {
    place.append(table("Peaks", `In percent: the difference from ${names[0]}, as a part of the largest component of the quantity there.`,
      ["column", ...names, ...names.slice(1).map((name) => `${name}, %`)],
      peaks.map(({ column, values, differences }) => [inUnit(column, unitOf(runs[0], column)), ...values.map((value) => number(value)), ...differences.map(percent)])));
  }
}

function inputText(run, title) {
  return element("details", { class: "card" }, element("summary", {}, title), element("pre", { tabindex: 0 }, run.input));
}

function eventTable(run) {
  const row = (event) => element("tr", {}, ...[event.step, number(event.time), event.event, event.message].map((cell) => element("td", {}, String(cell))));
  const shown = run.events.slice(0, 200);
  const rest = run.events.length - shown.length + run.more_events;
  return element("section", { class: "card" }, element("h2", {}, "Events"), element("table", { class: "events" },
    element("thead", {}, element("tr", {}, ...[stepName(run), inUnit(isStatic(run) ? "load fraction" : "t", unitOf(run, "time")), "event", ""].map((head) => element("th", { scope: "col" }, head)))),
    element("tbody", {}, ...shown.map(row))), rest > 0 ? element("p", { class: "note" }, `and ${rest} more in events.csv`) : null);
}

function showFoot(place, runs, version) {
  const key = (name) => element("kbd", {}, name);
  const thinned = runs.filter((run) => run.history.kept < run.history.written).map((run) =>
    element("p", {}, `${runs.length > 1 ? `${run.name}: ` : ""}the charts have ${grouped(run.history.kept)} of the ${grouped(run.history.written)} rows of history.csv: from each of some ${grouped(run.history.buckets)} stretches of the run its first row and those with the smallest and the largest value of every column. No peak is missing.`));
  place.append(
    element("p", {}, key("space"), " plays, ", key("←"), " ", key("→"), " go by frames, ", key(","), " ", key("."), " by steps, ", key("Home"), " ", key("End"),
      " to the ends. Click or drag in a chart to move the time, drag with ", key("shift"), " or press ", key("+"), " ", key("−"), " to zoom, double-click or ", key("0"),
      " to see all. In the motion: drag to turn, right button to shift, wheel (after a click) to zoom."),
    ...thinned,
    element("p", {}, `Written by Emmy ${version}. This file is complete: it loads nothing. Charts: uPlot (MIT); 3D: OGL (Unlicense).`));
}
