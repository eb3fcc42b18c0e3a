// Lines of equal value on a grid, by marching squares; corners are linear between.

const EDGES = [[0, 1], [1, 2], [2, 3], [3, 0]];

// Segments [[x, y], [x, y]] in grid units of the level on values (rows x columns).
export function segments(values, columns, rows, level) {
  const found = [];
  for (let r = 0; r + 1 < rows; r++) {
    for (let c = 0; c + 1 < columns; c++) {
      const corners = [[c, r], [c + 1, r], [c + 1, r + 1], [c, r + 1]];
      const heights = corners.map(([x, y]) => values[y * columns + x] - level);
      const crossed = EDGES.filter(([a, b]) => (heights[a] < 0) !== (heights[b] < 0)).map(([a, b]) => {
        const share = heights[a] / (heights[a] - heights[b]);
        return corners[a].map((from, d) => from + share * (corners[b][d] - from));
      });
      for (let k = 0; k + 1 < crossed.length; k += 2) found.push([crossed[k], crossed[k + 1]]);
    }
  }
  return found;
}
