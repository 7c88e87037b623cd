// Colours of lines and of fields.

const DASHES = [[], [7, 4], [2, 3], [9, 3, 2, 3], [4, 4], [12, 4], [1, 4], [6, 2, 1, 2]];

function hue(index) {
  return style(`--c${index % 8}`);
}

// A sample of a run's line.
function keySample(index, dash = DASHES[index % DASHES.length], colour = `var(--c${index % 8})`, width = 2) {
  return element("svg", { width: 20, height: 8, viewBox: "0 0 20 8", "aria-hidden": "true" },
    element("line", { x1: 0, y1: 4, x2: 20, y2: 4, style: `stroke:${colour}`, "stroke-width": width, "stroke-dasharray": dash.join(" ") }));
}

// Perceptually uniform maps, as 17 of their colours: viridis (Smith and van der Walt 2015, CC0) and for signed fields
// the diverging one of Moreland (2009).
const MAPS = {
  viridis: "440154 48186a 472d7b 424086 3b528b 33638d 2c728e 26828e 21918c 1fa088 28ae80 3fbc73 5ec962 84d44b addc30 d8e219 fde725",
  diverging: "3b4cc0 4e68d8 6282ea 779af7 8db0fe a3c2fe b9d0f9 ccd9ed dddcdc ecd3c5 f5c4ac f7b093 f4987a eb7d62 dd5f4b ca3b37 b40426",
};

// 256 colours of a map, `[256][3]`.
function colourMap(name) {
  const stops = MAPS[name].split(" ").map((hex) => [0, 2, 4].map((at) => parseInt(hex.slice(at, at + 2), 16)));
  const colours = new Uint8Array(256 * 3);
  for (let i = 0; i < 256; i++) {
    const at = (i / 255) * (stops.length - 1), low = Math.min(Math.floor(at), stops.length - 2);
    for (let c = 0; c < 3; c++) colours[3 * i + c] = Math.round(stops[low][c] + (at - low) * (stops[low + 1][c] - stops[low][c]));
  }
  return colours;
}

// Draws a map from left to right.
function drawMap(canvas, name) {
  const colours = colourMap(name);
  [canvas.width, canvas.height] = [256, 1];
  const context = canvas.getContext("2d");
  const image = context.createImageData(256, 1);
  for (let i = 0; i < 256; i++) {
    image.data.set([colours[3 * i], colours[3 * i + 1], colours[3 * i + 2], 255], 4 * i);
  }
  context.putImageData(image, 0, 0);
}
