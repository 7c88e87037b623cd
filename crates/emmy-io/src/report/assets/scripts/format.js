// Numbers and pieces of the page.

// A number with some significant digits, without the zeros that carry nothing.
function number(value, digits = 4) {
  if (value === null || value === undefined) return "–";
  if (!Number.isFinite(value)) return String(value);
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= 1e-3 && size < 1e5) return String(Number(value.toPrecision(digits)));
  return value.toExponential(digits - 1).replace(/\.?0+e/, "e").replace("e+", "e");
}

// A number in a column of readings, always of the same width.
function reading(value) {
  if (value === null || value === undefined || Number.isNaN(value)) return "–";
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (Number.isInteger(value) && size < 1e6) return String(value);
  if (size >= 1e-2 && size < 1e5) return value.toPrecision(5);
  return value.toExponential(2).replace("e+", "e");
}

function grouped(count) {
  return count === null || count === undefined ? "–" : count.toLocaleString("en").replaceAll(",", "\u202f");
}

function duration(seconds) {
  if (seconds < 60) return `${number(seconds, 3)} s`;
  if (seconds < 3600) return `${Math.floor(seconds / 60)} min ${Math.round(seconds % 60)} s`;
  return `${Math.floor(seconds / 3600)} h ${Math.round((seconds % 3600) / 60)} min`;
}

// An element with attributes and children; texts are texts.
function element(name, attributes = {}, ...children) {
  const made = name === "svg" || name === "path" || name === "line" || name === "text" || name === "circle"
    ? document.createElementNS("http://www.w3.org/2000/svg", name) : document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key.startsWith("on")) made.addEventListener(key.slice(2), value);
    else if (value === true) made.setAttribute(key, "");
    else if (value !== false && value !== null && value !== undefined) made.setAttribute(key, value);
  }
  made.append(...children.filter((child) => child !== null && child !== undefined));
  return made;
}

// A switch between some names: its element, and `show` for the one that is chosen.
function choiceOf(names, choose) {
  const buttons = names.map((name, i) => element("button", { type: "button", onclick: () => choose(i) }, name));
  const show = (index) => buttons.forEach((button, i) => button.setAttribute("aria-pressed", String(i === index)));
  return { node: element("span", { class: "switch", role: "group" }, ...buttons), show };
}

// A text with a unit, if there is one: `force [N]`.
function inUnit(text, unit) {
  return [text, unit && `[${unit}]`].filter(Boolean).join(" ");
}

// A number of the summary, marked with its key: it can be checked against the file.
function ofSummary(run, key, text) {
  return element("span", { class: "num", "data-run": run.name, "data-key": key }, text ?? number(run.summary[key]));
}

function style(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

const isStill = matchMedia("(prefers-reduced-motion: reduce)");
const isDark = matchMedia("(prefers-color-scheme: dark)");
