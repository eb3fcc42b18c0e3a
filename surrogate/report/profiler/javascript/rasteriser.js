// Triangles into a depth buffer: for every pixel which triangle is nearest, and its value.

const FAR = -1e30;

// Unit normals of points, as three arrays, from the triangles around them.
export function normalsOf(surface, triangles) {
  const [x, y, z] = surface;
  const normals = surface.map((own) => new Float64Array(own.length));
  const [first, second, third] = triangles;
  const [nx, ny, nz] = normals;
  for (let t = 0; t < first.length; t++) {
    const a = first[t];
    const b = second[t];
    const c = third[t];
    const ux = x[b] - x[a];
    const uy = y[b] - y[a];
    const uz = z[b] - z[a];
    const vx = x[c] - x[a];
    const vy = y[c] - y[a];
    const vz = z[c] - z[a];
    const across = uy * vz - uz * vy;
    const along = uz * vx - ux * vz;
    const up = ux * vy - uy * vx;
    nx[a] += across; nx[b] += across; nx[c] += across;
    ny[a] += along; ny[b] += along; ny[c] += along;
    nz[a] += up; nz[b] += up; nz[c] += up;
  }
  for (let i = 0; i < x.length; i++) {
    const size = Math.sqrt(nx[i] ** 2 + ny[i] ** 2 + nz[i] ** 2) || 1;
    nx[i] /= size;
    ny[i] /= size;
    nz[i] /= size;
  }
  return normals;
}

export function buffersOf(width, height) {
  const count = width * height;
  return { width, height, depth: new Float32Array(count), value: new Float32Array(count),
    light: new Float32Array(count), triangle: new Int32Array(count) };
}

// Fills the buffers; corners: arrays a point of {across, down, near, value, light}.
export function rasterise(buffers, triangles, { across, down, near, value, light }) {
  const { width, height, depth } = buffers;
  depth.fill(FAR);
  buffers.triangle.fill(-1);
  const [first, second, third] = triangles;
  for (let t = 0; t < first.length; t++) {
    const [a, b, c] = [first[t], second[t], third[t]];
    const [ax, ay] = [across[a], down[a]];
    const [bx, by, cx, cy] = [across[b] - ax, down[b] - ay, across[c] - ax, down[c] - ay];
    const area = bx * cy - cx * by;
    if (Math.abs(area) < 1e-9) continue;
    const left = Math.max(0, Math.ceil(ax + Math.min(0, bx, cx) - 0.5));
    const right = Math.min(width - 1, Math.floor(ax + Math.max(0, bx, cx) - 0.5));
    const top = Math.max(0, Math.ceil(ay + Math.min(0, by, cy) - 0.5));
    const floor = Math.min(height - 1, Math.floor(ay + Math.max(0, by, cy) - 0.5));
    for (let y = top; y <= floor; y++) {
      const py = y + 0.5 - ay;
      for (let x = left; x <= right; x++) {
        const px = x + 0.5 - ax;
        const v = (px * cy - cx * py) / area;
        const w = (bx * py - px * by) / area;
        const u = 1 - v - w;
        if (u < -1e-6 || v < -1e-6 || w < -1e-6) continue;
        const at = y * width + x;
        const nearness = u * near[a] + v * near[b] + w * near[c];
        if (nearness <= depth[at]) continue;
        depth[at] = nearness;
        buffers.value[at] = u * value[a] + v * value[b] + w * value[c];
        buffers.light[at] = u * light[a] + v * light[b] + w * light[c];
        buffers.triangle[at] = t;
      }
    }
  }
}

// Shares of the corners at a pixel's middle, to read what lies there.
export function sharesAt({ across, down }, [a, b, c], x, y) {
  const [bx, by] = [across[b] - across[a], down[b] - down[a]];
  const [cx, cy] = [across[c] - across[a], down[c] - down[a]];
  const [px, py] = [x + 0.5 - across[a], y + 0.5 - down[a]];
  const area = bx * cy - cx * by;
  const [v, w] = [(px * cy - cx * py) / area, (bx * py - px * by) / area];
  return [1 - v - w, v, w];
}
