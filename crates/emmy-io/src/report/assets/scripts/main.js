// Puts the page together.

const manifest = JSON.parse(document.getElementById("manifest").textContent);

// Marks and scales of a run in the charts.
function prepared(run) {
  const largest = (values) => values.reduce((most, value) => (value > most ? value : most), 0);
  run.largest = {
    linear_momentum: run.summary.largest_linear_momentum ?? largest(run.norm("linear_momentum")),
    angular_momentum: run.summary.largest_angular_momentum,
  };
  const end = run.time[run.time.length - 1];
  // The loads of a static analysis grow with the load fraction, whatever their histories are.
  if (isStatic(run)) run.loads = [];
  run.shaded = loadedIntervals(run, end);
  const names = (loads) => (loads.length > 2 ? `${loads.length} loads` : loads.map((load) => load.label).join(", "));
  const shaded = names(run.loads.filter((load) => load.intervals !== null));
  const always = names(run.loads.filter((load) => load.intervals === null));
  const notes = [shaded && `shaded: ${shaded}`, always && `throughout: ${always}`];
  run.loadNote = notes.filter(Boolean).join("; ");
  run.marks = run.events.slice(0, 300).map((event) => ({ time: event.time, title: `${stepName(run)} ${event.step}, ${timeText(run, event.time)}: ${event.message || event.event}` }));
  return run;
}

// Intervals in which some load acts, joined. Loads that act throughout shade nothing.
function loadedIntervals(run, end) {
  const all = run.loads.flatMap((load) => load.intervals ?? []).map(([from, to]) => [from, Math.min(to ?? end, end)]).sort((a, b) => a[0] - b[0]);
  const joined = [];
  for (const [from, to] of all) {
    const last = joined[joined.length - 1];
    if (last && from <= last[1]) last[1] = Math.max(last[1], to);
    else if (to > from) joined.push([from, to]);
  }
  return joined;
}

// The height that the head and the controls leave to the motion in the window. It grows as the head is scrolled away, at
// most to the height of the charts beside it.
function giveRoom() {
  const [stage, viewer, viewport, charts, transport] = [".stage", "#viewer", "#viewport", "#charts", "#transport"].map((name) => document.querySelector(name));
  const set = () => {
    // On a narrow page the stage has no box of its own.
    const place = stage.getClientRects().length ? stage : viewer;
    const above = place.getBoundingClientRect().top, controls = viewer.offsetHeight - viewport.offsetHeight;
    const room = (above) => innerHeight - above - controls - transport.offsetHeight - 10;
    const isBeside = charts.getBoundingClientRect().left >= viewer.getBoundingClientRect().right;
    const most = isBeside ? Math.min(room(Math.max(above, 13)), charts.offsetHeight - controls) : 0;
    const height = Math.max(room(above + scrollY), most);
    document.documentElement.style.setProperty("--room", `${Math.floor(height)}px`);
  };
  ["verdict", "transport", "viewer-tools", "viewer-foot"].map((id) => document.getElementById(id)).forEach((node) => new ResizeObserver(set).observe(node));
  addEventListener("resize", set);
  addEventListener("scroll", set, { passive: true });
  set();
}

// The page of one run, or of several.
async function showRuns(manifest) {
  showHeading(manifest.runs);
  const runs = (await Promise.all(manifest.runs.map((run, index) => readRun(index, run)))).map(prepared);
  // A run that has just started may have no row yet.
  const endOf = (run) => run.time[run.time.length - 1] ?? 0;
  const longest = runs.reduce((a, b) => (endOf(b) > endOf(a) ? b : a));
  const clock = new Clock(Math.min(...runs.map((run) => run.time[0] ?? 0)), endOf(longest));
  showVerdict(document.getElementById("verdict"), runs, clock);
  const withFrames = runs.filter((run) => run.frames), transport = document.getElementById("transport");
  let viewer = null;
  if (withFrames.length) {
    document.querySelector(".stage").classList.add("with-viewer");
    viewer = new Viewer(document.getElementById("viewer"), runs, clock);
  }
  showCharts(document.getElementById("charts"), runs, clock);
  showTransport(transport, clock, longest, withFrames.length ? withFrames[0].array("frames/time") : longest.time, runs.length === 1);
  if (viewer) transport.append(viewer.filmButton);
  showDetails(document.getElementById("details"), runs, manifest.differences);
  showFoot(document.getElementById("foot"), runs, manifest.version);
  giveRoom();
  // An address that ends in #t=2.5 shows that time.
  const wanted = Number(location.hash.match(/^#t=(.+)$/)?.[1] ?? NaN);
  if (Number.isFinite(wanted)) clock.set(wanted);
  else if (!isStill.matches && withFrames.length && runs.length === 1) clock.play();
}

try {
  const [{ modes, curves }] = manifest.runs;
  await (modes ? showModes(manifest) : curves ? showCurves(manifest) : showRuns(manifest));
  document.documentElement.dataset.ready = "true";
} catch (error) {
  const fault = document.getElementById("fault");
  fault.hidden = false;
  fault.textContent = `This page could not be drawn: ${error.message}. The numbers stand in summary.json and history.csv.`;
  throw error;
}
