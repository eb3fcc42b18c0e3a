"use strict";
const shape = JSON.parse(document.getElementById("shape").textContent);
const levels = shape.z.length, rays = shape.scan[0].length;
const peak = Math.max(1, ...shape.residual.flat().map(Math.abs));
// From dark to light, so that it reads in black and white too.
const stops = [[0, 32, 76], [62, 81, 108], [124, 123, 120], [186, 175, 107], [255, 233, 69]];
function colour(value, light) {
  const place = Math.min(Math.max((value / peak + 1) / 2, 0), 1) * (stops.length - 1);
  const k = Math.min(Math.floor(place), stops.length - 2), t = place - k;
  const mixed = stops[k].map((c, i) => Math.round((c + t * (stops[k + 1][i] - c)) * light));
  return `rgb(${mixed})`;
}
function fitted(canvas) {
  const ratio = window.devicePixelRatio || 1, box = canvas.getBoundingClientRect();
  canvas.width = box.width * ratio; canvas.height = box.height * ratio;
  const pen = canvas.getContext("2d");
  pen.scale(ratio, ratio);
  return [pen, box.width, box.height];
}

const leg = document.getElementById("leg"), map = document.getElementById("map");
let turn = 0.8, tilt = 0.12, shown = "scan";
const middle = shape.scan.flat().reduce((s, p) => [s[0] + p[0], s[1] + p[1]], [0, 0])
  .map(s => s / (levels * rays));
// Screen across, screen up, nearness to the viewer. Turn 0 looks from the front.
function seen(x, y, z) {
  const a = x - middle[0], b = y - middle[1], c = z - shape.length / 2;
  const across = -a * Math.cos(turn) - b * Math.sin(turn);
  const near = b * Math.cos(turn) - a * Math.sin(turn);
  return [across, c * Math.cos(tilt) - near * Math.sin(tilt),
          near * Math.cos(tilt) + c * Math.sin(tilt)];
}
function drawLeg() {
  const [pen, width, height] = fitted(leg);
  pen.clearRect(0, 0, width, height);
  const size = 0.86 * Math.min(height / (shape.length + 40), width / 250);
  const place = p => [width / 2 + size * p[0], height / 2 - size * p[1]];
  const skin = shape[shown], step = 2, faces = [];
  const points = skin.map((ring, i) => ring.map(p => seen(p[0], p[1], shape.z[i])));
  for (let i = 0; i < levels - 1; i += step) {
    const up = Math.min(i + step, levels - 1);
    for (let j = 0; j < rays; j++) {
      const k = (j + 1) % rays;
      const corners = [points[i][j], points[i][k], points[up][k], points[up][j]];
      const u = corners[2].map((c, n) => c - corners[0][n]);
      const v = corners[3].map((c, n) => c - corners[1][n]);
      const normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
      const light = Math.abs(normal[2]) / Math.hypot(...normal);
      faces.push([corners.reduce((s, c) => s + c[2], 0), corners, shape.residual[i][j], light]);
    }
  }
  faces.sort((a, b) => a[0] - b[0]);
  for (const [, corners, residual, light] of faces) {
    pen.beginPath();
    corners.forEach((c, n) => n ? pen.lineTo(...place(c)) : pen.moveTo(...place(c)));
    pen.closePath();
    pen.fillStyle = pen.strokeStyle = colour(residual, 0.45 + 0.55 * light);
    pen.fill(); pen.stroke();
  }
  pen.lineWidth = 2; pen.font = "13px system-ui, sans-serif";
  for (const [name, level] of Object.entries(shape.levels)) ring(pen, place, points, name, level);
  disc(pen, place);
}
function ring(pen, place, points, name, level) {
  const k = Math.min(Math.max(level / shape.length, 0), 1) * (levels - 1);
  const i = Math.min(Math.floor(k), levels - 2), t = k - i;
  const line = points[i].map((p, j) => p.map((c, n) => c + t * (points[i + 1][j][n] - c)));
  const far = line.reduce((s, p) => s + p[2], 0) / rays;
  pen.strokeStyle = "#fff";
  for (const style of [["#fff", 4], ["#000", 1.6]]) {
    [pen.strokeStyle, pen.lineWidth] = style;
    pen.beginPath();
    line.forEach((p, j) => {
      const q = line[(j + 1) % rays];
      if (p[2] + q[2] < 2 * far) return;
      pen.moveTo(...place(p)); pen.lineTo(...place(q));
    });
    pen.stroke();
  }
  const right = line.reduce((best, p) => p[0] > best[0] ? p : best);
  pen.fillStyle = "#000";
  const words = `${name}, ${level.toFixed(0)} mm`, edge = pen.canvas.getBoundingClientRect().width;
  const left = Math.min(place(right)[0] + 8, edge - pen.measureText(words).width - 4);
  pen.fillText(words, left, place(right)[1] + 4);
}
function disc(pen, place) {
  if (!shape.sensor.length) return;
  const rim = shape.sensor.map(p => seen(...p));
  const centre = rim.reduce((s, p) => s.map((c, n) => c + p[n] / rim.length), [0, 0, 0]);
  if (centre[2] < seen(...middle, shape.sensor[0][2])[2]) return;
  pen.beginPath();
  rim.forEach((p, j) => j ? pen.lineTo(...place(p)) : pen.moveTo(...place(p)));
  pen.closePath();
  pen.fillStyle = "rgba(255, 255, 255, .55)"; pen.fill();
  pen.strokeStyle = "#000"; pen.lineWidth = 1.6; pen.stroke();
  pen.fillStyle = "#000"; pen.textAlign = "center";
  pen.fillText("sensor", place(centre)[0], place(centre)[1] + 4);
  pen.textAlign = "start";
}

const edge = {left: 46, right: 74, top: 10, bottom: 46};
function drawMap() {
  const [pen, width, height] = fitted(map);
  const across = width - edge.left - edge.right, up = height - edge.top - edge.bottom;
  const x = j => edge.left + across * j / rays, y = i => edge.top + up * (1 - i / (levels - 1));
  pen.clearRect(0, 0, width, height);
  for (let i = 0; i < levels - 1; i++) for (let j = 0; j < rays; j++) {
    pen.fillStyle = colour(shape.residual[i][j], 1);
    pen.fillRect(x(j), y(i + 1), across / rays + 1, up / (levels - 1) + 1);
    if (shape.holes[i][j]) {
      pen.strokeStyle = "#fff"; pen.lineWidth = 1;
      pen.beginPath(); pen.moveTo(x(j), y(i)); pen.lineTo(x(j + 1), y(i + 1)); pen.stroke();
    }
  }
  pen.strokeStyle = "#fff"; pen.lineWidth = 1.5; pen.beginPath();
  for (let i = 0; i < levels - 1; i++) for (let j = 0; j < rays - 1; j++) {
    const here = shape.residual[i][j] > 0;
    if (here !== shape.residual[i][j + 1] > 0) { pen.moveTo(x(j + 1), y(i)); pen.lineTo(x(j + 1), y(i + 1)); }
    if (here !== shape.residual[i + 1][j] > 0) { pen.moveTo(x(j), y(i + 1)); pen.lineTo(x(j + 1), y(i + 1)); }
  }
  pen.stroke();
  pen.fillStyle = "#000"; pen.font = "13px system-ui, sans-serif"; pen.textAlign = "center";
  ["outside", "front", "inside", "back"].forEach((word, k) =>
    pen.fillText(word, x(k * rays / 4 + (k ? 0 : 3)), height - edge.bottom + 18));
  pen.fillText("side of the leg", edge.left + across / 2, height - 6);
  pen.textAlign = "end";
  for (let z = 0; z <= shape.length; z += 50) pen.fillText(z, edge.left - 6, y(z / shape.length * (levels - 1)) + 4);
  pen.save(); pen.translate(12, edge.top + up / 2); pen.rotate(-Math.PI / 2);
  pen.textAlign = "center"; pen.fillText("height, mm", 0, 0); pen.restore();
  pen.setLineDash([4, 3]); pen.strokeStyle = "#000"; pen.lineWidth = 1; pen.textAlign = "start";
  for (const [name, level] of Object.entries(shape.levels)) {
    const place = y(level / shape.length * (levels - 1));
    pen.beginPath(); pen.moveTo(edge.left, place); pen.lineTo(edge.left + across, place); pen.stroke();
  }
  pen.setLineDash([]);
  const bar = width - edge.right + 12;
  for (let k = 0; k < 60; k++) {
    pen.fillStyle = colour(peak * (k / 29.5 - 1), 1);
    pen.fillRect(bar, edge.top + up * (1 - (k + 1) / 60), 14, up / 60 + 1);
  }
  pen.fillStyle = "#000";
  [-1, -0.5, 0, 0.5, 1].forEach(part => pen.fillText(`${part > 0 ? "+" : ""}${(part * peak).toFixed(1)}`,
    bar + 18, edge.top + up * (1 - (part + 1) / 2) + (part === 1 ? 10 : part === -1 ? 0 : 4)));
  pen.fillText("mm", bar + 18, height - edge.bottom + 18);
}
map.addEventListener("pointermove", event => {
  const box = map.getBoundingClientRect();
  const j = Math.floor((event.clientX - box.left - edge.left) / (box.width - edge.left - edge.right) * rays);
  const i = Math.round((1 - (event.clientY - box.top - edge.top) / (box.height - edge.top - edge.bottom)) * (levels - 1));
  if (i < 0 || j < 0 || i >= levels || j >= rays) return;
  document.getElementById("reading").textContent =
    `height ${shape.z[i].toFixed(0)} mm, ${(j * 360 / rays).toFixed(0)} degrees from the outside ` +
    `towards the front: ${shape.residual[i][j].toFixed(2)} mm`;
});
let dragged = null;
leg.addEventListener("pointerdown", event => { dragged = [event.clientX, event.clientY]; leg.setPointerCapture(event.pointerId); });
leg.addEventListener("pointerup", () => { dragged = null; });
leg.addEventListener("pointermove", event => {
  if (!dragged) return;
  turn -= (event.clientX - dragged[0]) / 120;
  tilt = Math.min(Math.max(tilt + (event.clientY - dragged[1]) / 160, -1.3), 1.3);
  dragged = [event.clientX, event.clientY];
  drawLeg();
});
for (const button of document.querySelectorAll("[data-show]")) button.addEventListener("click", () => {
  shown = button.dataset.show;
  document.querySelectorAll("[data-show]").forEach(b => b.setAttribute("aria-pressed", b === button));
  drawLeg();
});
const views = {front: 0, inside: Math.PI / 2, back: Math.PI, outside: -Math.PI / 2};
for (const button of document.querySelectorAll("[data-view]")) button.addEventListener("click", () => {
  turn = views[button.dataset.view]; tilt = 0.12; drawLeg();
});
window.addEventListener("resize", () => { drawLeg(); drawMap(); });
drawLeg(); drawMap();
