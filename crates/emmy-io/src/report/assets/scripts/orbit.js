// The view: a camera on a sphere around a target, z (or y, for plane bodies) upwards.

class Orbit {
  constructor(camera, node, changed) {
    Object.assign(this, { camera, node, changed, target: [0, 0, 0], distance: 1, azimuth: 0, elevation: 0, pan: [0, 0, 0], up: [0, 0, 1] });
    this.pointers = new Map();
    node.addEventListener("pointerdown", (event) => this.down(event));
    node.addEventListener("pointermove", (event) => this.move(event));
    ["pointerup", "pointercancel"].forEach((name) => node.addEventListener(name, (event) => this.pointers.delete(event.pointerId)));
    node.addEventListener("contextmenu", (event) => event.preventDefault());
    node.addEventListener("wheel", (event) => {
      // Without the focus the wheel belongs to the page.
      if (document.activeElement !== node && !event.ctrlKey) return;
      event.preventDefault();
      this.zoom(Math.exp(0.0015 * event.deltaY * (event.deltaMode === 1 ? 20 : 1)));
    }, { passive: false });
  }

  down(event) {
    this.node.setPointerCapture(event.pointerId);
    this.node.focus({ preventScroll: true });
    this.pointers.set(event.pointerId, [event.clientX, event.clientY]);
  }

  move(event) {
    const last = this.pointers.get(event.pointerId);
    if (!last) return;
    const now = [event.clientX, event.clientY], [dx, dy] = [now[0] - last[0], now[1] - last[1]];
    if (this.pointers.size === 2) {
      const other = [...this.pointers].find(([id]) => id !== event.pointerId)[1];
      const gap = (point) => Math.hypot(point[0] - other[0], point[1] - other[1]);
      if (gap(now) > 0) this.zoom(gap(last) / gap(now));
      this.shift(dx / 2, dy / 2);
    } else if (event.buttons & 2 || event.ctrlKey) this.shift(dx, dy);
    else this.turn(-0.008 * dx, 0.008 * dy);
    this.pointers.set(event.pointerId, now);
  }

  // Distance from which the points of a box around the target are in sight, or without a box a ball of some radius.
  fit(box, radius) {
    const { fov, aspect } = this.camera;
    // Room is left for the legend above and the axes below.
    const high = 0.88 * Math.tan((fov * Math.PI) / 360), wide = 0.95 * Math.tan((fov * Math.PI) / 360) * (aspect || 1);
    const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    const [right, up, towards] = this.axes();
    const needed = (point) => {
      const at = point.map((x, i) => x - box.centre[i]);
      return dot(at, towards) + Math.max(Math.abs(dot(at, right)) / wide, Math.abs(dot(at, up)) / high);
    };
    this.distance = box ? box.points.reduce((most, point) => Math.max(most, needed(point)), 0) : radius / Math.sin(Math.atan(Math.min(high, wide)));
  }

  turn(azimuth, elevation) {
    this.isMoved = true;
    this.azimuth += azimuth;
    this.elevation = Math.min(Math.max(this.elevation + elevation, -1.5607), 1.5607);
    this.changed();
  }

  zoom(factor) {
    this.isMoved = true;
    this.distance *= factor;
    this.changed();
  }

  // Moves the target in the plane of the picture, by pixels.
  shift(dx, dy) {
    this.isMoved = true;
    const [right, up] = this.axes();
    const unit = (2 * this.distance * Math.tan((this.camera.fov * Math.PI) / 360)) / this.node.clientHeight;
    this.pan = this.pan.map((x, i) => x - unit * dx * right[i] + unit * dy * up[i]);
    this.changed();
  }

  look(azimuth, elevation) {
    [this.azimuth, this.elevation, this.pan, this.isMoved] = [azimuth, elevation, [0, 0, 0], false];
    this.changed();
  }

  // Unit vectors of the picture: to the right, upwards, towards the eye.
  axes() {
    const [ca, sa, ce, se] = [Math.cos(this.azimuth), Math.sin(this.azimuth), Math.cos(this.elevation), Math.sin(this.elevation)];
    const z = [[-sa, ca, 0], [-se * ca, -se * sa, ce], [ce * ca, ce * sa, se]];
    // With y upwards the axes are exchanged in turn: x, y, z for z, x, y.
    return this.up[1] === 1 ? z.map(([x, y, v]) => [y, v, x]) : z;
  }

  apply() {
    const towards = this.axes()[2];
    const target = this.target.map((x, i) => x + this.pan[i]);
    this.camera.up.set(...this.up);
    this.camera.position.set(...target.map((x, i) => x + this.distance * towards[i]));
    this.camera.lookAt(target);
    this.camera.perspective({ near: this.distance / 100, far: this.distance * 20 });
  }
}
