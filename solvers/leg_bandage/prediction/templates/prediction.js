"use strict";
// A small rasteriser: triangles into a depth buffer, with pressure and place on the skin
// interpolated to every pixel, so that pointing at a pixel reads it exactly.
const data = JSON.parse(document.getElementById("data").textContent);
const canvas = document.getElementById("skin"), reading = document.getElementById("reading");
const levels = data.points.length, rays = data.points[0].length;
const top_ = data.ticks[data.ticks.length - 1], step = data.ticks[1] - data.ticks[0];
const hand = data.mirrored ? -1 : 1;
const views = {front: 0, inside: hand * Math.PI / 2, back: Math.PI, outside: -hand * Math.PI / 2};
const reach = Math.max(...data.points.flat().map(p => Math.hypot(p[0], p[1])));
const tall = data.points[levels - 1][0][2] - data.points[0][0][2];
const home = {turn: views.inside - hand * 0.45, tilt: 0.1, zoom: 1};
let {turn, tilt, zoom} = home, buffers = null, picked = null;

const normals = data.points.map((ring, i) => ring.map((_, j) => {
  const a = data.points[i][(j + 1) % rays], b = data.points[i][(j + rays - 1) % rays];
  const c = data.points[Math.min(i + 1, levels - 1)][j], d = data.points[Math.max(i - 1, 0)][j];
  const u = a.map((x, n) => x - b[n]), v = c.map((x, n) => x - d[n]);
  const w = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
  return w.map(x => hand * x / Math.hypot(...w));
}));
const palette = new Uint8ClampedArray(3 * 256);
for (let k = 0; k < 256; k++) {
  const at = k / 255 * (data.stops.length - 1), n = Math.min(Math.floor(at), data.stops.length - 2);
  for (let c = 0; c < 3; c++)
    palette[3 * k + c] = data.stops[n][c] + (at - n) * (data.stops[n + 1][c] - data.stops[n][c]);
}

// Turn 0 looks from the front: across to the right, up, and nearness to the viewer.
function seen([x, y, z]) {
  const s = Math.sin(turn), c = Math.cos(turn), near = y * c - x * s;
  return [-x * c - y * s, z * Math.cos(tilt) - near * Math.sin(tilt),
          near * Math.cos(tilt) + z * Math.sin(tilt)];
}
function scaled(width, height) {
  return zoom * 0.94 * Math.min(height / (tall + 10), width / (2 * reach + 20));
}
function rasterise(width, height, size) {
  const count = width * height;
  if (!buffers || buffers.width !== width || buffers.height !== height)
    buffers = {width, height, depth: new Float32Array(count), pressure: new Float32Array(count),
               light: new Float32Array(count), row: new Float32Array(count), col: new Float32Array(count)};
  buffers.depth.fill(-1e9);
  const corner = data.points.map((ring, i) => ring.map((p, j) => {
    const [a, b, near] = seen(p), [na, nb, nn] = seen(normals[i][j]);
    return [width / 2 + size * a, height / 2 - size * b, near, data.pressure[i][j],
            nn > 0 ? 0.66 + 0.34 * Math.max(0, 0.8 * nn - 0.25 * na + 0.45 * nb) : -1, i, j];
  }));
  for (let i = 0; i < levels - 1; i++) for (let j = 0; j < rays; j++) {
    const k = (j + 1) % rays, a = corner[i][j], c = corner[i + 1][j];
    let b = corner[i][k], d = corner[i + 1][k];
    if (k === 0) { b = [...b]; d = [...d]; b[6] = d[6] = rays; }
    triangle(a, b, d); triangle(a, d, c);
  }
}
function triangle(a, b, c) {
  const {width, height, depth, pressure, light, row, col} = buffers;
  const area = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
  if (Math.abs(area) < 1e-9) return;
  const x0 = Math.max(0, Math.ceil(Math.min(a[0], b[0], c[0]) - 0.5));
  const x1 = Math.min(width - 1, Math.floor(Math.max(a[0], b[0], c[0]) - 0.5 + 1));
  const y0 = Math.max(0, Math.ceil(Math.min(a[1], b[1], c[1]) - 0.5));
  const y1 = Math.min(height - 1, Math.floor(Math.max(a[1], b[1], c[1]) - 0.5 + 1));
  for (let y = y0; y <= y1; y++) for (let x = x0; x <= x1; x++) {
    const px = x + 0.5, py = y + 0.5;
    const v = ((px - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (py - a[1])) / area;
    const w = ((b[0] - a[0]) * (py - a[1]) - (px - a[0]) * (b[1] - a[1])) / area;
    const u = 1 - v - w;
    if (u < -1e-6 || v < -1e-6 || w < -1e-6) continue;
    const at = y * width + x, near = u * a[2] + v * b[2] + w * c[2];
    if (near <= depth[at]) continue;
    depth[at] = near;
    pressure[at] = u * a[3] + v * b[3] + w * c[3];
    light[at] = u * a[4] + v * b[4] + w * c[4];
    row[at] = u * a[5] + v * b[5] + w * c[5];
    col[at] = u * a[6] + v * b[6] + w * c[6];
  }
}
function paint(pen) {
  const {width, height, depth, pressure, light} = buffers;
  const picture = pen.createImageData(width, height), out = picture.data;
  for (let at = 0; at < width * height; at++) {
    if (depth[at] < -1e8) continue;
    const tone = light[at], k = 3 * Math.min(255, Math.round(255 * pressure[at] / top_));
    if (tone < 0.3) { out.set([150, 154, 160, 255], 4 * at); continue; }  // the hollow inside
    const band = Math.floor(pressure[at] / step);
    const line = [at + 1, at + width].some(other => other < depth.length && light[other] > 0.3 &&
      depth[other] > depth[at] - 8 && Math.floor(pressure[other] / step) !== band);
    const bare = pressure[at] < data.bareUnder;
    const veil = line ? 0.55 : 0, ink = pressure[at] > 0.5 * top_ ? 255 : 0;
    for (let c = 0; c < 3; c++)
      out[4 * at + c] = (1 - veil) * (bare ? data.bare[c] : palette[k + c]) * tone + veil * ink;
    out[4 * at + 3] = 255;
  }
  pen.putImageData(picture, 0, 0);
}
function draw() {
  const box = canvas.getBoundingClientRect(), fine = Math.max(2, window.devicePixelRatio || 1);
  if (!box.width) return;
  const width = canvas.width = Math.round(box.width * fine), height = canvas.height = Math.round(box.height * fine);
  const size = scaled(width, height), pen = canvas.getContext("2d");
  rasterise(width, height, size);
  paint(pen);
  sensor(pen, fine, size);
  if (picked) mark(pen, fine, size);
}
function placed(p, size) {
  const [a, b, near] = seen(p);
  return [buffers.width / 2 + size * a, buffers.height / 2 - size * b, near];
}
function inSight([x, y, near]) {
  const at = Math.round(y) * buffers.width + Math.round(x);
  return near > (buffers.depth[at] ?? -1e9) - 3;
}
function sensor(pen, fine, size) {
  const rim = data.rim.map(p => placed(p, size));
  if (!rim.length) return;
  for (const [tone, wide] of [["#fff", 4.4], ["#000", 1.8]]) {
    pen.strokeStyle = tone; pen.lineWidth = wide * fine; pen.beginPath();
    rim.forEach((p, k) => {
      const q = rim[(k + 1) % rim.length];
      if (inSight(p) && inSight(q)) { pen.moveTo(p[0], p[1]); pen.lineTo(q[0], q[1]); }
    });
    pen.stroke();
  }
  const middle = [0, 1, 2].map(n => rim.reduce((s, p) => s + p[n] / rim.length, 0));
  if (rim.filter(inSight).length < rim.length / 2) return;
  words(pen, fine, `B1 ${data.value.toFixed(1)}`, middle[0], middle[1]);
}
function words(pen, fine, text, x, y) {
  pen.font = `600 ${13 * fine}px system-ui, sans-serif`;
  pen.textAlign = "center"; pen.textBaseline = "middle"; pen.lineJoin = "round";
  pen.lineWidth = 4 * fine; pen.strokeStyle = "#fff"; pen.strokeText(text, x, y);
  pen.fillStyle = "#000"; pen.fillText(text, x, y);
}
function mark(pen, fine, size) {
  const i = Math.round(picked[0]), j = Math.round(picked[1]) % rays;
  const p = placed(data.points[i][j], size);
  if (!inSight(p)) return;
  pen.beginPath(); pen.arc(p[0], p[1], 4 * fine, 0, 7);
  pen.fillStyle = "#fff"; pen.fill(); pen.lineWidth = 1.6 * fine; pen.strokeStyle = "#000"; pen.stroke();
}
function side(degrees) {
  const names = ["outside", "outside front", "front", "inside front", "inside", "inside back", "back", "outside back"];
  return names[Math.round(degrees / 45) % 8];
}
function read(event) {
  const box = canvas.getBoundingClientRect();
  const x = Math.floor((event.clientX - box.left) / box.width * buffers.width);
  const y = Math.floor((event.clientY - box.top) / box.height * buffers.height), at = y * buffers.width + x;
  if (x < 0 || y < 0 || x >= buffers.width || y >= buffers.height || buffers.depth[at] < -1e8 ||
      buffers.light[at] < 0.3) return null;
  const degrees = buffers.col[at] * 360 / rays % 360;
  const height = buffers.row[at] / (levels - 1) * (data.points[levels - 1][0][2] - data.points[0][0][2]);
  reading.textContent = `${buffers.pressure[at].toFixed(1)} mmHg, ${height.toFixed(0)} mm above the ankle cut, ${side(degrees)}`;
  return [buffers.row[at], buffers.col[at]];
}

let waiting = false;
function redraw() {
  if (waiting) return;
  waiting = true;
  requestAnimationFrame(() => { waiting = false; draw(); });
}
const held = new Map();
let moved = 0;
function spread() {
  const [a, b] = [...held.values()];
  return Math.hypot(a[0] - b[0], a[1] - b[1]);
}
function zoomBy(factor) { zoom = Math.min(Math.max(zoom * factor, 0.6), 6); redraw(); }
canvas.addEventListener("pointerdown", event => {
  held.set(event.pointerId, [event.clientX, event.clientY]); moved = 0;
  canvas.setPointerCapture(event.pointerId);
});
canvas.addEventListener("pointermove", event => {
  const before = held.get(event.pointerId);
  if (!before) { read(event); return; }
  const now = [event.clientX, event.clientY], wide = held.size === 2 ? spread() : 0;
  held.set(event.pointerId, now);
  if (held.size === 2) { zoomBy(spread() / wide); moved = 99; return; }
  moved += Math.hypot(now[0] - before[0], now[1] - before[1]);
  turn -= (now[0] - before[0]) / 120;
  if (event.pointerType === "mouse") tilt = Math.min(Math.max(tilt + (now[1] - before[1]) / 160, -1.4), 1.4);
  redraw();
});
for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, event => {
  held.delete(event.pointerId);
  if (end === "pointerup" && moved < 5) { picked = read(event); redraw(); }
});
canvas.addEventListener("wheel", event => {
  if (document.activeElement !== canvas && !event.ctrlKey) return;
  event.preventDefault();
  zoomBy(Math.exp(-event.deltaY / 500));
}, {passive: false});
const keys = {ArrowLeft: () => { turn += 0.12; }, ArrowRight: () => { turn -= 0.12; },
              ArrowUp: () => { tilt = Math.max(tilt - 0.12, -1.4); }, ArrowDown: () => { tilt = Math.min(tilt + 0.12, 1.4); },
              "+": () => zoomBy(1.15), "=": () => zoomBy(1.15), "-": () => zoomBy(1 / 1.15),
              "0": () => { ({turn, tilt, zoom} = home); }};
canvas.addEventListener("keydown", event => {
  if (!keys[event.key] || event.metaKey || event.ctrlKey) return;
  event.preventDefault(); keys[event.key](); redraw();
});
for (const button of document.querySelectorAll("[data-view]")) button.addEventListener("click", () => {
  turn = views[button.dataset.view]; tilt = 0.1; redraw();
});
for (const button of document.querySelectorAll("[data-zoom]"))
  button.addEventListener("click", () => zoomBy(Number(button.dataset.zoom)));
document.getElementById("turning").hidden = false;
new ResizeObserver(redraw).observe(canvas);
draw();
