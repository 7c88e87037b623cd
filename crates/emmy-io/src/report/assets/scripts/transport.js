// Play, step, scrub; the keyboard of the page.

const ICONS = { play: "M3 1 L13 7 L3 13 Z", pause: "M2 1 h4 v12 h-4 Z M8 1 h4 v12 h-4 Z", back: "M2 1 h2.4 v12 H2 Z M13 1 L5 7 L13 13 Z", forward: "M9.6 1 H12 v12 H9.6 Z M1 1 L9 7 L1 13 Z" };

function icon(name) {
  return element("svg", { viewBox: "0 0 14 14", "aria-hidden": "true" }, element("path", { d: ICONS[name] }));
}

// The button that plays and pauses, with the choice of the speed.
function playControls(clock) {
  const toggle = () => (clock.isPlaying ? clock.pause() : clock.play());
  const button = (name, label, act) => element("button", { type: "button", class: name, "aria-label": label, title: label, onclick: act }, icon(name));
  const play = button("play", "Play (space)", toggle);
  const speed = element("select", { "aria-label": "Speed", onchange: () => { clock.speed = Number(speed.value); } },
    ...[0.1, 0.25, 0.5, 1, 2, 4].map((value) => element("option", { value, selected: value === 1 }, `${value} ×`)));
  let wasPlaying = null;
  clock.follow(() => {
    if (wasPlaying === clock.isPlaying) return;
    wasPlaying = clock.isPlaying;
    play.replaceChildren(icon(wasPlaying ? "pause" : "play"));
    play.title = wasPlaying ? "Pause (space)" : "Play (space)";
    play.setAttribute("aria-label", play.title);
  });
  return { toggle, button, play, speed: element("label", { class: "wide" }, "Speed ", speed) };
}

function showTransport(place, clock, run, times, isAlone) {
  place.hidden = false;
  const { toggle, button, play, speed } = playControls(clock);
  const slider = element("input", { type: "range", min: 0, max: 10000, step: 1, value: 0, "aria-label": "Time" });
  slider.addEventListener("input", () => {
    clock.isPlaying = false;
    clock.set(clock.start + ((clock.end - clock.start) * slider.value) / 10000);
  });
  const output = element("output", { "aria-live": "off" });
  place.append(button("back", "Step back (left arrow)", () => clock.step(times, -1)), play,
    button("forward", "Step forward (right arrow)", () => clock.step(times, 1)), slider, output, speed);
  clock.follow((time) => {
    const row = lastBefore(run.time, time);
    slider.value = clock.end > clock.start ? Math.round((10000 * (time - clock.start)) / (clock.end - clock.start)) : 0;
    const step = run.column("step")[row] ?? 0;
    const unit = unitOf(run, "time");
    output.replaceChildren(isStatic(run) ? "load fraction = " : "t = ", element("b", {}, number(time, 5)), unit && ` ${unit}`,
      isAlone ? `, ${stepName(run)} ${step} of ${run.summary.steps}` : "");
    slider.setAttribute("aria-valuetext", `${timeText(run, time, 5)}, ${stepName(run)} ${step}`);
  });
  listen(clock, toggle, times, run.time);
}

function listen(clock, toggle, times, rows) {
  const middle = () => {
    const { min, max } = charts[0].plot.scales.x;
    return { span: max - min, at: clock.time };
  };
  const scale = (factor) => {
    const { span, at } = middle();
    const wanted = Math.min(span * factor, clock.end - clock.start);
    const low = Math.min(Math.max(at - wanted / 2, clock.start), clock.end - wanted);
    zoom(low, low + wanted);
  };
  onKeys({
    " ": toggle, ArrowRight: () => clock.step(times, 1), ArrowLeft: () => clock.step(times, -1),
    PageDown: () => clock.step(times, 10), PageUp: () => clock.step(times, -10),
    ".": () => clock.step(rows, 1), ",": () => clock.step(rows, -1),
    Home: () => { clock.isPlaying = false; clock.set(clock.start); }, End: () => { clock.isPlaying = false; clock.set(clock.end); },
    "+": () => scale(0.5), "-": () => scale(2), 0: () => zoom(clock.start, clock.end),
  });
}

// Actions of keys anywhere on the page.
function onKeys(actions) {
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || (event.shiftKey && event.key !== "+")) return;
    const on = event.target.tagName;
    // Elements that use the key themselves keep it.
    if (on === "SELECT" || on === "TEXTAREA" || on === "PRE" || event.target.type === "text" || (event.target.type === "range" && !event.target.closest(".transport"))) return;
    if (event.key === " " && (on === "BUTTON" || on === "SUMMARY" || on === "A" || (on === "INPUT" && event.target.type === "checkbox"))) return;
    if (event.key.startsWith("Page") && !(on === "INPUT" || on === "CANVAS")) return;
    const action = actions[event.key];
    if (!action) return;
    event.preventDefault();
    action();
  });
}
