// The motion as a film, recorded while it plays.

const FILM = "video/webm";

// Why this browser cannot record; nothing if it can.
function whyNoFilm() {
  if (typeof MediaRecorder === "undefined") return "This browser cannot record: it has no MediaRecorder.";
  return MediaRecorder.isTypeSupported(FILM) ? null : "This browser cannot record WebM.";
}

class Film {
  constructor(scene, name, ended) {
    // Codecs want even numbers of pixels.
    this.canvas = element("canvas", { width: scene.width & ~1, height: scene.height & ~1 });
    this.recorder = new MediaRecorder(this.canvas.captureStream(), { mimeType: FILM, videoBitsPerSecond: 8e6 });
    const parts = [];
    this.recorder.addEventListener("dataavailable", ({ data }) => parts.push(data));
    this.recorder.addEventListener("stop", () => {
      const address = URL.createObjectURL(new Blob(parts, { type: FILM }));
      element("a", { href: address, download: `${name}.webm` }).click();
      setTimeout(() => URL.revokeObjectURL(address), 60000);
      ended();
    });
    this.recorder.start();
  }

  // Adds a picture, with its caption and its scales.
  add(scene, caption, quantity, scales) {
    const { width, height } = this.canvas, context = this.canvas.getContext("2d");
    const unit = scene.width / scene.clientWidth, line = 17 * unit, margin = 12 * unit, bar = 240 * unit;
    const text = (words, align, x, y) => {
      context.textAlign = align;
      context.fillText(words, x, y);
    };
    context.fillStyle = style("--scene-2");
    context.fillRect(0, 0, width, height);
    context.drawImage(scene, 0, 0, width, height);
    context.fillStyle = style("--ink");
    context.font = `${13 * unit}px ${style("--sans")}`;
    context.textBaseline = "middle";
    text(caption, "left", margin, height - margin);
    const [left, right] = [width - margin - bar, width - margin];
    let y = margin;
    text(quantity, "right", right, y);
    for (const { title, map, shown } of scales) {
      if (title) text(title, "right", right, (y += line));
      context.drawImage(map, left, (y += line) - line / 4, bar, line / 2);
      text(number(shown[0], 3), "left", left, (y += line));
      text(number(shown[1], 3), "right", right, y);
    }
  }

  stop() {
    if (this.recorder.state !== "inactive") this.recorder.stop();
  }
}
