// The body of a run in three dimensions.

class Scene {
  constructor(canvas, frames) {
    Object.assign(this, { canvas, frames });
    this.renderer = new OGL.Renderer({ canvas, alpha: true, premultipliedAlpha: true, antialias: true, webgl: 2, dpr: Math.min(devicePixelRatio || 1, 2) });
    const gl = (this.gl = this.renderer.gl);
    if (!this.renderer.isWebgl2) throw new Error("no WebGL 2");
    gl.clearColor(0, 0, 0, 0);
    gl.enable(gl.POLYGON_OFFSET_FILL);
    gl.polygonOffset(1, 1);
    this.camera = new OGL.Camera(gl, { fov: 32 });
    this.root = new OGL.Transform();
    this.map = new OGL.Texture(gl, { width: 256, height: 1, generateMipmaps: false, magFilter: gl.NEAREST, minFilter: gl.NEAREST });
    const reference = frames.points;
    this.position = { size: 3, data: new Float32Array(reference), usage: gl.DYNAMIC_DRAW };
    this.value = { size: 1, data: new Float32Array(frames.n), usage: gl.DYNAMIC_DRAW };
    this.beyond = { size: 1, data: new Float32Array(frames.n).fill(-1), usage: gl.DYNAMIC_DRAW };
    const sharp = outline(frames);
    this.surface = this.mesh(SURFACE, { position: this.position, value: this.value, beyond: this.beyond }, frames.triangles, gl.TRIANGLES);
    this.cellEdges = this.lines(this.position, frames.edges);
    this.outline = this.lines(this.position, sharp);
    this.ghost = this.lines({ size: 3, data: new Float32Array(reference) }, frames.links.length ? this.joined(sharp, frames.links) : sharp);
    this.addLinks();
    this.addJoints(frames.run?.joints ?? []);
    this.addArrow();
  }

  joined(a, b) {
    const all = new Uint32Array(a.length + b.length);
    all.set(a);
    all.set(b, a.length);
    return all;
  }

  mesh(shader, attributes, index, mode, uniforms = {}, options = {}) {
    if (index && !index.length) return null;
    const { gl } = this;
    const program = new OGL.Program(gl, { ...shader, cullFace: false, uniforms: { map: { value: this.map }, ...uniforms }, ...options });
    const geometry = new OGL.Geometry(gl, index ? { ...attributes, index: { data: index } } : attributes);
    const mesh = new OGL.Mesh(gl, { mode, geometry, program, frustumCulled: false });
    mesh.setParent(this.root);
    return mesh;
  }

  lines(position, index) {
    const options = { transparent: true, depthWrite: false };
    return this.mesh(LINES, { position, beyond: this.beyond }, index, this.gl.LINES, { ink: { value: [0, 0, 0, 1] } }, options);
  }

  // Links are ribbons of a width on the screen, with discs at their nodes.
  addLinks() {
    const { gl, frames } = this, { links } = frames;
    this.hasLinks = links.length > 0;
    if (!this.hasLinks) return;
    const n = links.length / 2;
    const index = new Uint32Array(6 * n), side = new Float32Array(4 * n);
    for (let link = 0; link < n; link++) {
      index.set([0, 1, 2, 2, 1, 3].map((corner) => 4 * link + corner), 6 * link);
      // The far end sees the line the other way round.
      side.set([1, -1, -1, 1], 4 * link);
    }
    this.ends = { size: 3, data: new Float32Array(12 * n), usage: gl.DYNAMIC_DRAW };
    this.others = { size: 3, data: new Float32Array(12 * n), usage: gl.DYNAMIC_DRAW };
    this.endValues = { size: 1, data: new Float32Array(4 * n), usage: gl.DYNAMIC_DRAW };
    this.endBeyond = { size: 1, data: new Float32Array(4 * n), usage: gl.DYNAMIC_DRAW };
    this.screen = { value: [1, 1] };
    const attributes = { position: this.ends, other: this.others, side: { size: 1, data: side }, value: this.endValues, beyond: this.endBeyond };
    this.mesh(LINKS, attributes, index, gl.TRIANGLES, { size: this.screen, width: { value: 4 * this.renderer.dpr } });
    const nodes = new Uint32Array(new Set(links));
    this.mesh(NODES, { position: this.position, value: this.value, beyond: this.beyond }, nodes, gl.POINTS, { width: { value: 15 * this.renderer.dpr } });
  }

  setLinks() {
    if (!this.hasLinks) return;
    const { links } = this.frames, at = this.position.data;
    for (let i = 0; i < links.length; i++) {
      const link = i >> 1, end = i & 1, node = links[i], other = links[i ^ 1];
      for (const corner of [4 * link + 2 * end, 4 * link + 2 * end + 1]) {
        for (let axis = 0; axis < 3; axis++) {
          this.ends.data[3 * corner + axis] = at[3 * node + axis];
          this.others.data[3 * corner + axis] = at[3 * other + axis];
        }
        this.endValues.data[corner] = this.value.data[node];
        this.endBeyond.data[corner] = this.beyond.data[node];
      }
    }
    [this.ends, this.others, this.endValues, this.endBeyond].forEach((attribute) => { attribute.needsUpdate = true; });
  }

  // Rings at the joints. A place of a rigid body is linear in its centre and the ends of its axes, which links join.
  addJoints(joints) {
    const places = joints.flatMap((joint) => joint.places ?? []);
    this.marks = places.map((place) => this.mark(place));
    this.markAt = { size: 3, data: new Float32Array(3 * places.length), usage: this.gl.DYNAMIC_DRAW };
    if (!places.length) return;
    this.markInk = { value: [0, 0, 0, 1] };
    const uniforms = { ink: this.markInk, width: { value: 19 * this.renderer.dpr } };
    this.mesh(RINGS, { position: this.markAt }, new Uint32Array(places.keys()), this.gl.POINTS, uniforms);
  }

  // Nodes with weights, or a fixed place.
  mark({ at, centre, ground }) {
    if (ground) return { at };
    const { points, links, n } = this.frames;
    const of = (node) => [0, 1, 2].map((axis) => points[3 * node + axis]);
    const distance = (node, place) => Math.hypot(...of(node).map((x, axis) => x - place[axis]));
    let own = 0;
    for (let node = 1; node < n; node++) if (distance(node, centre ?? at) < distance(own, centre ?? at)) own = node;
    const terms = [];
    for (let i = 0; centre && i < links.length; i++) {
      // A point is a link with itself.
      if (links[i] !== own || links[i ^ 1] === own) continue;
      const arm = of(links[i ^ 1]).map((x, axis) => x - points[3 * own + axis]);
      const along = arm.reduce((sum, x, axis) => sum + x * (at[axis] - centre[axis]), 0);
      terms.push([links[i ^ 1], along / arm.reduce((sum, x) => sum + x * x, 0)]);
    }
    return { terms: [[own, 1 - terms.reduce((sum, [, weight]) => sum + weight, 0)], ...terms] };
  }

  setJoints() {
    const at = this.position.data;
    this.marks.forEach(({ at: fixed, terms }, i) => {
      for (let axis = 0; axis < 3; axis++) {
        this.markAt.data[3 * i + axis] = fixed ? fixed[axis] : terms.reduce((sum, [node, weight]) => sum + weight * at[3 * node + axis], 0);
      }
    });
    this.markAt.needsUpdate = true;
  }

  // The arrow is drawn twice: faintly through the body, and fully where it is in sight.
  addArrow() {
    const { position, head } = arrowTriangles();
    const attributes = () => ({ position: { size: 3, data: position }, head: { size: 1, data: head } });
    this.arrow = { start: { value: [0, 0, 0] }, along: { value: [0, 0, 1] }, reach: { value: 1 }, thick: { value: 0.01 } };
    const arrow = (ink, options) => this.mesh(ARROW, attributes(), null, this.gl.TRIANGLES, { ...this.arrow, ink }, options);
    this.arrowInk = [{ value: [0, 0, 0, 1] }, { value: [0, 0, 0, 0.3] }];
    this.arrows = [arrow(this.arrowInk[0], {}), arrow(this.arrowInk[1], { transparent: true, depthTest: false, depthWrite: false })];
  }

  setInk() {
    const channel = (text) => text.split(",").map((part) => Number(part) / 255);
    const hex = (text) => [1, 3, 5].map((at) => parseInt(text.slice(at, at + 2), 16) / 255);
    const edge = channel(style("--edge"));
    if (this.cellEdges) this.cellEdges.program.uniforms.ink.value = [...edge, 0.28];
    if (this.outline) this.outline.program.uniforms.ink.value = [...edge, 0.75];
    if (this.ghost) this.ghost.program.uniforms.ink.value = [...hex(style("--ghost")), 0.55];
    if (this.markInk) this.markInk.value = [...hex(style("--c2")), 1];
    const ink = hex(style("--c1"));
    this.arrowInk[0].value = [...ink, 1];
    this.arrowInk[1].value = [...ink, 0.3];
  }

  setMap(name) {
    const colours = colourMap(name), image = new Uint8Array(256 * 4).fill(255);
    for (let i = 0; i < 256; i++) image.set(colours.subarray(3 * i, 3 * i + 3), 4 * i);
    this.map.image = image;
    this.map.needsUpdate = true;
  }

  // Hides regions, and all that is beyond a section of the reference configuration.
  setShown(hidden, section) {
    const { points, regions, n } = this.frames, beyond = this.beyond.data;
    for (let node = 0; node < n; node++) beyond[node] = section ? points[3 * node + section.axis] - section.at : -1;
    regions.filter(({ name }) => hidden.has(name)).forEach(({ start, n }) => beyond.fill(1, start, start + n));
    this.beyond.needsUpdate = true;
  }

  // Gives values their places in the scales, each that of a region or of all nodes.
  setScales(scales) {
    const { values, n } = this.frames;
    for (const { region, low, high } of scales) {
      const from = region?.start ?? 0, to = from + (region?.n ?? n);
      for (let node = from; node < to; node++) this.value.data[node] = (values[node] - low) / (high - low);
    }
    this.value.needsUpdate = true;
  }

  // Shows the displacement of the frames, magnified. Returns the middle of the body.
  setFrame(factor) {
    const { points, displacement, n } = this.frames, at = this.position.data;
    const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    for (let i = 0; i < 3 * n; i++) {
      at[i] = points[i] + factor * displacement[i];
      const axis = i % 3;
      if (at[i] < low[axis]) low[axis] = at[i];
      if (at[i] > high[axis]) high[axis] = at[i];
    }
    this.position.needsUpdate = true;
    this.setLinks();
    this.setJoints();
    return low.map((a, i) => (a + high[i]) / 2);
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.canvas.parentNode;
    if (!width || !height) return;
    this.renderer.setSize(width, height);
    this.camera.perspective({ aspect: width / height });
    if (this.screen) this.screen.value = [width * this.renderer.dpr, height * this.renderer.dpr];
  }

  draw() {
    this.renderer.render({ scene: this.root, camera: this.camera });
  }
}
