// The picture of a scene: surface by the rasteriser, lines and labels over it where they are seen.
import { projection } from "./camera.js";
import { shadeOf, shades } from "./colours.js";
import { between, locating } from "./locating.js";
import { buffersOf, normalsOf, rasterise, sharesAt } from "./rasteriser.js";

// Grey of a surface that no field colours.
const UNCOLOURED = [168, 180, 194];
// Where the light comes from: across, up, towards the viewer.
const LIGHT = [-0.35, 0.45, 0.82];
// Share of the scene's size by which a line may lie behind the surface and is still seen.
const SUNK = 0.006;

export function painter(canvas, scene) {
  const pen = canvas.getContext("2d", { willReadFrequently: true });
  const located = scene.coordinates.length > 1 ? locating(scene.triangles, scene.coordinates) : null;
  let [buffers, corners] = [null, null];

  // Places in space (or null) of a line or mark, which may lie on the surface.
  function placesOf(own, surface) {
    return Array.from(own[0], (_, i) => {
      if (own.length === 3) return own.map((component) => component[i]);
      const at = located(own[0][i], own[1][i]);
      return at && between(surface, at);
    });
  }

  function picture(found, { view, fine, limits, step, labels }) {
    const box = canvas.getBoundingClientRect();
    const [width, height] = [box.width, box.height].map((size) => Math.round(size * fine));
    if (!width || !height) return;
    if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
    if (buffers?.width !== width || buffers.height !== height) buffers = buffersOf(width, height);
    const seenFrom = projection(view, scene.extent, width, height);
    const { place } = seenFrom;
    corners = cornersOf(found, seenFrom, width, height);
    rasterise(buffers, scene.triangles, corners);
    pen.putImageData(painted(limits, step), 0, 0);
    const seen = (at) => {
      if (!at) return null;
      const [x, y, near] = place(...at);
      const pixel = Math.floor(y) * width + Math.floor(x);
      const hidden = buffers.triangle[pixel] >= 0 && buffers.depth[pixel] > near + SUNK * scene.size;
      return hidden ? null : [x, y];
    };
    found.lines.forEach((own, k) => stroke(placesOf(own, found.surface).map(seen), scene.lines[k].closed, fine));
    found.marks.forEach((own, k) => {
      const [at] = placesOf(own, found.surface).map(seen);
      if (at) words(labels[k], at, fine);
    });
  }

  // What the rasteriser needs of every point; plain loops, for it is done at every frame.
  function cornersOf({ surface: [x, y, z], values }, { axes, scale }, width, height) {
    const count = x.length;
    const made = { value: values ?? new Float64Array(count) };
    for (const key of ["across", "down", "near", "light"]) made[key] = new Float64Array(count);
    const [nx, ny, nz] = normalsOf([x, y, z], scene.triangles);
    const [lx, ly, lz] = [0, 1, 2].map((d) => axes.reduce((sum, axis, k) => sum + LIGHT[k] * axis[d], 0));
    const [[rx, ry, rz], [ux, uy, uz], [tx, ty, tz]] = axes;
    const [mx, my, mz] = scene.extent.middle;
    for (let i = 0; i < count; i++) {
      const dx = x[i] - mx;
      const dy = y[i] - my;
      const dz = z[i] - mz;
      made.across[i] = width / 2 + scale * (rx * dx + ry * dy + rz * dz);
      made.down[i] = height / 2 - scale * (ux * dx + uy * dy + uz * dz);
      made.near[i] = tx * dx + ty * dy + tz * dz;
      const sign = nx[i] * tx + ny[i] * ty + nz[i] * tz >= 0 ? 1 : -1;
      made.light[i] = sign * (nx[i] * lx + ny[i] * ly + nz[i] * lz);
    }
    return made;
  }

  // Shades with lines of equal value between their bands, and a rim around the surface.
  function painted(limits, step) {
    const { width, height, value, light, triangle } = buffers;
    const image = pen.createImageData(width, height);
    const out = image.data;
    const rim = getComputedStyle(canvas).color.match(/[\d.]+/g).map(Number);
    const [low, high] = limits ?? [0, 1];
    for (let at = 0; at < width * height; at++) {
      if (triangle[at] < 0) continue;
      const right = at + 1;
      const below = at + width;
      const tone = 0.74 + 0.26 * Math.min(Math.max(light[at], 0), 1);
      const share = (value[at] - low) / (high - low);
      const from = limits ? shadeOf(share) : 0;
      const shade = limits ? shades : UNCOLOURED;
      const edge = triangle[right] < 0 || triangle[below] < 0 || triangle[at - 1] < 0 || triangle[at - width] < 0;
      const band = Math.floor(value[at] / step);
      const line = limits && ((triangle[right] >= 0 && Math.floor(value[right] / step) !== band)
        || (triangle[below] >= 0 && Math.floor(value[below] / step) !== band));
      const veil = edge ? 0.8 : line ? 0.3 : 0;
      const ink = share > 0.5 ? 255 : 0;
      for (let c = 0; c < 3; c++) {
        out[4 * at + c] = (1 - veil) * tone * shade[from + c] + veil * (edge ? rim[c] : ink);
      }
      out[4 * at + 3] = 255;
    }
    return image;
  }

  function stroke(points, closed, fine) {
    pen.lineJoin = pen.lineCap = "round";
    for (const [tone, wide] of [["rgb(255 255 255 / 75%)", 3.4], ["#14181d", 1.5]]) {
      pen.strokeStyle = tone;
      pen.lineWidth = wide * fine;
      pen.beginPath();
      const all = closed ? [...points, points[0]] : points;
      all.forEach((point, i) => {
        if (!point) return;
        if (i && all[i - 1]) pen.lineTo(...point);
        else pen.moveTo(...point);
      });
      pen.stroke();
    }
  }

  function words(text, [x, y], fine) {
    pen.font = `600 ${13 * fine}px system-ui, sans-serif`;
    [pen.textAlign, pen.textBaseline, pen.lineJoin] = ["center", "middle", "round"];
    [pen.lineWidth, pen.strokeStyle, pen.fillStyle] = [4 * fine, "#fff", "#000"];
    pen.strokeText(text, x, y);
    pen.fillText(text, x, y);
  }

  // Value and coordinates under a pointer; null beside the surface.
  function readAt(event) {
    if (!buffers) return null;
    const box = canvas.getBoundingClientRect();
    const x = Math.floor((event.clientX - box.left) / box.width * buffers.width);
    const y = Math.floor((event.clientY - box.top) / box.height * buffers.height);
    const t = buffers.triangle[y * buffers.width + x] ?? -1;
    if (t < 0 || x < 0 || x >= buffers.width) return null;
    const own = scene.triangles.map((numbers) => numbers[t]);
    const shares = sharesAt(corners, own, x, y);
    return {
      value: buffers.value[y * buffers.width + x],
      coordinates: scene.coordinates.map(({ name, unit, period, rows }) => {
        const first = rows[0][own[0]];
        const value = own.reduce((sum, i, n) => {
          const turns = period ? Math.round((first - rows[0][i]) / period) * period : 0;
          return sum + shares[n] * (rows[0][i] + turns);
        }, 0);
        return { name, unit, value: period ? value - period * Math.floor(value / period) : value };
      }),
    };
  }

  return { picture, readAt };
}
