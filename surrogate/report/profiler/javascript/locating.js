// Where on a surface a pair of its coordinates lies: triangles in the plane of both.

const CELLS = 40;

// locating(triangles, coordinates)(u, v): {corners, shares}, or null off the surface. Triangles
// over the end of a period are taken apart from their first corner.
export function locating(triangles, coordinates) {
  const [us, vs] = coordinates.slice(0, 2).map(({ rows }) => rows[0]);
  const periods = coordinates.slice(0, 2).map(({ period }) => period);
  const near = (value, to, period) =>
    (period ? value + period * Math.round((to - value) / period) : value);
  const lows = [us, vs].map((own) => own.reduce((a, b) => Math.min(a, b), Infinity));
  const highs = [us, vs].map((own) => own.reduce((a, b) => Math.max(a, b), -Infinity));
  const widths = lows.map((low, d) => (periods[d] || highs[d] - low || 1) / CELLS);
  const cell = (value, d) => {
    const k = Math.floor((value - lows[d]) / widths[d]);
    return periods[d] ? ((k % CELLS) + CELLS) % CELLS : Math.min(Math.max(k, 0), CELLS - 1);
  };
  const cells = Array.from({ length: CELLS * CELLS }, () => []);
  const [first, second, third] = triangles;
  for (let t = 0; t < first.length; t++) {
    const corners = [first[t], second[t], third[t]];
    const u = corners.map((i) => near(us[i], us[corners[0]], periods[0]));
    const v = corners.map((i) => near(vs[i], vs[corners[0]], periods[1]));
    const area = (u[1] - u[0]) * (v[2] - v[0]) - (u[2] - u[0]) * (v[1] - v[0]);
    if (area === 0) continue;
    const own = { corners, u, v, area };
    for (let a = Math.floor((Math.min(...u) - lows[0]) / widths[0]);
      a <= Math.floor((Math.max(...u) - lows[0]) / widths[0]); a++) {
      for (let b = Math.floor((Math.min(...v) - lows[1]) / widths[1]);
        b <= Math.floor((Math.max(...v) - lows[1]) / widths[1]); b++) {
        cells[cell(lows[0] + (a + 0.5) * widths[0], 0) * CELLS
          + cell(lows[1] + (b + 0.5) * widths[1], 1)].push(own);
      }
    }
  }
  return (u, v) => {
    for (const { corners, u: us3, v: vs3, area } of cells[cell(u, 0) * CELLS + cell(v, 1)]) {
      const x = near(u, (us3[0] + us3[1] + us3[2]) / 3, periods[0]) - us3[0];
      const y = near(v, (vs3[0] + vs3[1] + vs3[2]) / 3, periods[1]) - vs3[0];
      const b = (x * (vs3[2] - vs3[0]) - (us3[2] - us3[0]) * y) / area;
      const c = ((us3[1] - us3[0]) * y - x * (vs3[1] - vs3[0])) / area;
      if (b > -1e-9 && c > -1e-9 && b + c < 1 + 1e-9) return { corners, shares: [1 - b - c, b, c] };
    }
    return null;
  };
}

// The place (3,) in space of corners and their shares.
export function between(surface, { corners, shares }) {
  return surface.map((own) => corners.reduce((sum, i, n) => sum + shares[n] * own[i], 0));
}
