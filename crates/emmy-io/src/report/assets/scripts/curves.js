// The page of spectra and harmonic responses: charts over the frequency.

// A chart of a page; `axis`: label and scale of its ordinate.
function chartOfCurves(run, { axis, lines }) {
  const [, title, unit] = axis.label.match(/^(.*?)( \[.*\])?$/);
  const drawn = lines.map(({ label, values }, i) => ({
    label, times: run.frequencies, values: values.map((value) => (axis.log && !(value > 0) ? null : value)),
    colour: `--c${i % 8}`, dash: DASHES[i % DASHES.length] }));
  return { title: title[0].toUpperCase() + title.slice(1), unit: (unit ?? "").trim(), log: axis.log, logAbscissa: run.abscissa.log, height: 230,
    abscissa: run.abscissa.label, choices: [{ lines: drawn }], data: (lines) => [run.frequencies, ...lines.map(({ values }) => values)] };
}

function showCurves({ runs: [run], version }) {
  const id = (name) => document.getElementById(name);
  id("title").textContent = run.title;
  id("subtitle").textContent = `${run.name}: ${run.caption}`;
  document.title = `${run.name}: ${run.title}`;
  document.body.classList.add("of-modes");
  const { frequencies } = run;
  const clock = new Clock(frequencies[0], frequencies[frequencies.length - 1]);
  // The cursor begins at the largest value of the first line.
  const [first] = run.curves.flatMap(({ lines }) => lines);
  if (first) clock.set(frequencies[first.values.indexOf(Math.max(...first.values.map((value) => value ?? -Infinity)))] ?? frequencies[0]);
  const output = element("output", { "aria-live": "polite" });
  id("status").append(output);
  run.curves.forEach((curve) => new Chart(id("charts"), chartOfCurves(run, curve), clock));
  clock.follow((f) => {
    charts.forEach((chart) => chart.show(f));
    output.textContent = `${run.abscissa.label.replace(/ \[.*/, "")}: ${number(f, 5)}${run.abscissa.label.replace(/^[^[]*\[?|\]$/g, " ").trimEnd()}`;
  });
  isDark.addEventListener("change", () => charts.forEach((chart) => chart.build()));
  const near = (count) => clock.step(frequencies, count);
  onKeys({ ArrowLeft: () => near(-1), ArrowRight: () => near(1), Home: () => clock.set(clock.start), End: () => clock.set(clock.end) });
  id("details").append(element("section", { class: "card" }, element("h2", {}, "Data"), fileList(run)));
  if (run.input) id("details").append(inputText(run, "Input, with all defaults"));
  const key = (name) => element("kbd", {}, name);
  id("foot").append(element("p", {}, "Click or drag in a chart to move the cursor, ", key("←"), " ", key("→"), " go by frequencies, drag with ", key("shift"), " to zoom, double-click to see all."),
    element("p", {}, `Written by Emmy ${version}. This file is complete: it loads nothing. Charts: uPlot (MIT).`));
}
