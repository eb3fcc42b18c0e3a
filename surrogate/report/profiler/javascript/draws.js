// Random points of a study's laws, in coded values.
//   {kind: "uniform"}              of the coded value
//   {kind: "levels", count}        equally likely
//   {kind: "steps", values, up_to} allowed coded values, and probabilities to reach them
//   {kind: "table", values}        quantiles at normal scores, evenly from -REACH to REACH
import { normalCdf } from "../../../portable/javascript/normal.js";

const REACH = 6;

function step(values, upTo, u) {
  let k = 0;
  while (k < values.length - 1 && u >= upTo[k]) k++;
  return values[k];
}

function tabulated(values, z) {
  const last = values.length - 1;
  const place = Math.min(Math.max((z + REACH) / (2 * REACH) * last, 0), last);
  const k = Math.min(Math.floor(place), last - 1);
  return values[k] + (place - k) * (values[k + 1] - values[k]);
}

// Turns a column of uniform numbers into coded values.
function quantiles(law, u) {
  const last = law.count - 1;
  switch (law.kind) {
    case "uniform": for (let i = 0; i < u.length; i++) u[i] = 2 * u[i] - 1; break;
    case "levels":
      for (let i = 0; i < u.length; i++) {
        u[i] = 2 * Math.min(Math.floor(u[i] * law.count), last) / last - 1;
      }
      break;
    default: for (let i = 0; i < u.length; i++) u[i] = step(law.values, law.up_to, u[i]);
  }
  return u;
}

// Columns (size,) of normal numbers with the correlation whose lower factor is given by rows.
function correlated(factor, columns, size) {
  return factor.map((row, j) => {
    const sum = new Float64Array(size);
    for (let k = 0; k <= j; k++) {
      const share = row[k];
      if (share !== 0) for (let i = 0; i < size; i++) sum[i] += share * columns[k][i];
    }
    return sum;
  });
}

// One column (size,) a parameter; held[j] is a coded value, or undefined for one that varies.
export function drawn({ parameters, correlation }, held, size, random) {
  const scores = correlation && correlated(correlation,
    parameters.map(() => random.normals(new Float64Array(size))), size);
  return parameters.map(({ law }, j) => {
    const column = new Float64Array(size);
    if (held[j] !== undefined) return column.fill(held[j]);
    if (law.kind === "table") {
      const own = scores ? scores[j] : random.normals(column);
      for (let i = 0; i < size; i++) column[i] = tabulated(law.values, own[i]);
      return column;
    }
    return quantiles(law, scores ? scores[j].map(normalCdf) : random.uniforms(column));
  });
}
