// The frames of a run: displacements and fields of its surface, read from their whole numbers when they are shown.

class Frames {
  constructor(run) {
    Object.assign(this, { run, fields: run.frames.fields, n: run.frames.n_nodes });
    this.times = run.array("frames/time");
    this.steps = run.array("frames/step");
    this.points = run.array("mesh/points");
    this.triangles = run.array("mesh/triangles");
    this.edges = run.array("mesh/edges");
    this.links = run.array("mesh/links");
    this.whole = run.array("frames/displacement");
    [this.low, this.high] = [run.array("frames/displacement_min"), run.array("frames/displacement_max")];
    this.displacement = new Float32Array(3 * this.n);
    this.values = new Float32Array(this.n);
    let start = 0;
    this.regions = run.frames.regions.map((region) => ({ ...region, start: (start += region.n) - region.n }));
    this.ranges = new Map();
    this.boxes = new Map();
  }

  // Sets the displacement of a frame, `[n][3]`. The numbers are differences from node to node, component by component.
  readDisplacement(frame) {
    const { n, displacement } = this;
    for (let axis = 0; axis < 3; axis++) {
      const low = this.low[3 * frame + axis], unit = (this.high[3 * frame + axis] - low) / 65535;
      const from = (3 * frame + axis) * n;
      for (let node = 0, whole = 0; node < n; node++) {
        whole = (whole + this.whole[from + node]) & 0xffff;
        displacement[3 * node + axis] = low + unit * whole;
      }
    }
    return displacement;
  }

  // Sets the values of a field in a frame, `[n]`. The displacement of the frame must have been read.
  readField(name, frame) {
    const { n, values, displacement } = this;
    if (name === "displacement") {
      for (let node = 0; node < n; node++) {
        values[node] = Math.hypot(displacement[3 * node], displacement[3 * node + 1], displacement[3 * node + 2]);
      }
      return;
    }
    const whole = this.run.array(`frames/${name}`);
    const low = this.run.array(`frames/${name}_min`)[frame], high = this.run.array(`frames/${name}_max`)[frame];
    const from = frame * n, unit = (high - low) / 255;
    for (let node = 0, sum = 0; node < n; node++) {
      sum = (sum + whole[from + node]) & 0xff;
      values[node] = low + unit * sum;
    }
  }

  // Bounds of the values of the frame: of all nodes, or of a region. Where regions meet, the value is a mean of them,
  // which counts for none if the region has other nodes.
  bounds(region) {
    const { start, n, inside } = region ?? { start: 0, n: this.n, inside: this.n };
    let low = Infinity, high = -Infinity;
    for (const value of this.values.subarray(start, start + (inside || n))) {
      if (value < low) low = value;
      if (value > high) high = value;
    }
    return [low, high];
  }

  // Bounds of a field over all frames, of all nodes or of a region.
  rangeOf(name, region) {
    const key = `${name} ${region?.start}`;
    if (!this.ranges.has(key)) {
      let range = [Infinity, -Infinity];
      for (let frame = 0; frame < this.times.length; frame++) {
        if (!region && name !== "displacement") {
          range = union(range, [this.run.array(`frames/${name}_min`)[frame], this.run.array(`frames/${name}_max`)[frame]]);
          continue;
        }
        this.readDisplacement(frame);
        this.readField(name, frame);
        range = union(range, this.bounds(region));
      }
      this.ranges.set(key, range);
    }
    return this.ranges.get(key);
  }

  // Box around the reference, or around the whole motion with displacements magnified; modes go both ways. `points`: of
  // each frame the outermost nodes in some directions.
  box(factor, goesBack = false) {
    const key = `${factor} ${goesBack}`;
    if (!this.boxes.has(key)) this.boxes.set(key, this.measure(factor, goesBack));
    return this.boxes.get(key);
  }

  measure(factor, goesBack) {
    const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity], points = [];
    const add = (displacement, factor) => {
      const at = (i) => this.points[i] + (displacement ? factor * displacement[i] : 0);
      const outermost = DIRECTIONS.map(([x, y, z]) => {
        let most = -Infinity, node = 0;
        for (let i = 0; i < 3 * this.n; i += 3) {
          const reach = x * at(i) + y * at(i + 1) + z * at(i + 2);
          if (reach > most) {
            most = reach;
            node = i;
          }
        }
        return [at(node), at(node + 1), at(node + 2)];
      });
      for (const at of outermost) {
        points.push(at);
        for (let axis = 0; axis < 3; axis++) [low[axis], high[axis]] = [Math.min(low[axis], at[axis]), Math.max(high[axis], at[axis])];
      }
    };
    if (factor === 0) add(null);
    else for (let frame = 0; frame < this.times.length; frame++) {
      this.readDisplacement(frame);
      add(this.displacement, factor);
      if (goesBack) add(this.displacement, -factor);
    }
    return { low, high, points, centre: low.map((a, i) => (a + high[i]) / 2), size: Math.hypot(...low.map((a, i) => high[i] - a)) };
  }
}

function union([a, b], [c, d]) {
  return [Math.min(a, c), Math.max(b, d)];
}

// To the faces, edges and corners of a cube.
const DIRECTIONS = [-1, 0, 1].flatMap((x) => [-1, 0, 1].flatMap((y) => [-1, 0, 1].map((z) => [x, y, z]))).filter((d) => d.some(Boolean));

// Edges where the surface ends or bends by more than 25 degrees, in the reference configuration.
function outline(frames) {
  const { triangles, points, edges } = frames;
  const normals = new Map();
  const at = (node) => [points[3 * node], points[3 * node + 1], points[3 * node + 2]];
  for (let i = 0; i < triangles.length; i += 3) {
    const corners = [triangles[i], triangles[i + 1], triangles[i + 2]];
    const [a, b, c] = corners.map(at);
    const [u, v] = [b.map((x, k) => x - a[k]), c.map((x, k) => x - a[k])];
    const cross = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    const size = Math.hypot(...cross) || 1;
    const normal = cross.map((x) => x / size);
    corners.forEach((corner, k) => {
      const other = corners[(k + 1) % 3];
      const key = Math.min(corner, other) * frames.n + Math.max(corner, other);
      if (!normals.has(key)) normals.set(key, []);
      normals.get(key).push(normal);
    });
  }
  const sharp = [];
  for (let i = 0; i < edges.length; i += 2) {
    const [a, b] = [edges[i], edges[i + 1]];
    const sides = normals.get(Math.min(a, b) * frames.n + Math.max(a, b)) ?? [];
    const isSharp = sides.length !== 2 || Math.abs(sides[0].reduce((sum, x, k) => sum + x * sides[1][k], 0)) < 0.906;
    if (isSharp) sharp.push(a, b);
  }
  return new Uint32Array(sharp);
}
