// Viridis from light to dark (Smith and van der Walt): even steps to the eye, safe for colour-blind
// readers, and readable in black and white.

const VIRIDIS = [[253, 231, 37], [189, 223, 38], [122, 209, 81], [68, 191, 112],
  [34, 168, 132], [33, 145, 140], [42, 120, 142], [53, 95, 141], [65, 68, 135], [72, 36, 117],
  [68, 1, 84]];

const palette = new Uint8Array(3 * 256);
for (let k = 0; k < 256; k++) {
  const at = k / 255 * (VIRIDIS.length - 1);
  const n = Math.min(Math.floor(at), VIRIDIS.length - 2);
  for (let c = 0; c < 3; c++) {
    palette[3 * k + c] = VIRIDIS[n][c] + (at - n) * (VIRIDIS[n + 1][c] - VIRIDIS[n][c]);
  }
}

// Where the colour of a share in [0, 1] stands in `shades`.
export function shadeOf(share) {
  return 3 * Math.min(Math.max(Math.round(255 * share), 0), 255);
}

export const shades = palette;

export const gradient = `linear-gradient(to top, ${VIRIDIS.map((own) => `rgb(${own})`).join()})`;
