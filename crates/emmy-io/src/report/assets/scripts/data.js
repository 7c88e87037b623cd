// The data of the page: a manifest in JSON, and for each run one compressed block of typed arrays.

const BYTES = { f64: 8, f32: 4, u32: 4, u16: 2, u8: 1 };
const ARRAYS = { f64: Float64Array, f32: Float32Array, u32: Uint32Array, u16: Uint16Array, u8: Uint8Array };

// Bytes of a block, out of base64 and zlib.
async function inflated(text) {
  const packed = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

// An array whose bytes are stored in planes: all first bytes, all second bytes, and so on, which compresses better.
function unpacked(block, { type, length, offset }) {
  const width = BYTES[type];
  const bytes = new Uint8Array(length * width);
  for (let plane = 0; plane < width; plane++) {
    const from = offset + plane * length;
    for (let i = 0; i < length; i++) bytes[i * width + plane] = block[from + i];
  }
  return new ARRAYS[type](bytes.buffer);
}

// A run with `array(name)`, which is null for missing arrays, and `column(name)` of its history.
async function readRun(index, run) {
  const block = await inflated(document.getElementById(`run-${index}`).textContent);
  const places = new Map(run.arrays.map((place) => [place.name, place]));
  const cache = new Map();
  const array = (name) => {
    if (!places.has(name)) return null;
    if (!cache.has(name)) cache.set(name, unpacked(block, places.get(name)));
    return cache.get(name);
  };
  const column = (name) => array(`history/${name}`);
  const norm = (name) => {
    const [x, y, z] = ["x", "y", "z"].map((axis) => column(`${name}_${axis}`));
    return x.map((_, i) => Math.hypot(x[i], y[i], z[i]));
  };
  return { ...run, index, array, column, norm, time: column("time") };
}

// Unit of a column or a field of a run; empty without units.
function unitOf(run, name) {
  const { units } = run;
  if (!units) return "";
  return unitsOfModes(run, units.system)[name] ?? units.columns[name] ?? units.fields[name] ?? "";
}

// Words for the frame of reference of a quantity, of a probe if it has one of its own.
function relation(run, name, probe) {
  const frame = run.relative_to?.probes[probe] ?? run.relative_to?.all;
  const isOfMotion = ["position", "displacement", "velocity", "acceleration"].includes(name);
  return frame && frame !== "ground" && isOfMotion ? ` relative to ${frame}` : "";
}

// Units of natural modes, whose table has no file of units.
function unitsOfModes(run, { mass, time, frequency }) {
  if (!run.modes) return {};
  return { frequency, period: time, angular_frequency: `1/${time}`, effective_mass_x: mass, effective_mass_y: mass, effective_mass_z: mass };
}

// A static analysis has increments of its loads in place of steps in time.
function isStatic(run) {
  return run.summary.scheme === "static";
}

function stepName(run) {
  return isStatic(run) ? "increment" : "step";
}

// A time with its name: `t = 0.2 s`, or `load fraction = 0.2`.
function timeText(run, time, digits) {
  return `${isStatic(run) ? "load fraction" : "t"} = ${timeValue(run, time, digits)}`;
}

function timeValue(run, time, digits) {
  return [number(time, digits), unitOf(run, "time")].filter(Boolean).join(" ");
}

// Index of the last of ascending times that is not after a time; 0 before the first.
function lastBefore(times, time) {
  const tolerance = 1e-9 * Math.max(Math.abs(time), Math.abs(times[times.length - 1]));
  let low = 0, high = times.length;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (times[middle] <= time + tolerance) low = middle; else high = middle;
  }
  return low;
}
