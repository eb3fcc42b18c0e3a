// Universal kriging with a product Matern 5/2 correlation (Santner, Williams, Notz 2018,
// equation 3.2.8). The factor of the correlations is made when a deviation is first asked for.
import { backward, cholesky, forward } from "./algebra.js";
import { addedTerms, columnValues, powersOf } from "./columns.js";
import { keptFor } from "./kept.js";
import { addProduct } from "./sums.js";

const ROOT5 = Math.sqrt(5);

// sum_k factors[k] * (process k), and the variance of the sum, the processes independent.
export function processes(models, factors) {
  const alike = new Map();
  models.forEach((model, k) => {
    const key = `${Array.from(model.lengths)}|${model.nugget}`;
    if (!alike.has(key)) alike.set(key, [[], []]);
    alike.get(key)[0].push(model);
    alike.get(key)[1].push(factors[k]);
  });
  const groups = [...alike].map(([key, [some, own]]) => group(key, some, own));
  const predict = (points, size, mean, variance) =>
    groups.forEach((one) => one(points, size, mean, variance));
  return Object.assign(predict, { cost: groups.reduce((sum, one) => sum + one.cost, 0) });
}

// Processes of the same runs, lengths and nugget are one process with added weights.
function group(key, models, factors) {
  const { columns, points: runs, lengths, nugget } = models[0];
  const n = runs.length;
  const sum = (of) => models.reduce((total, model, k) => total + of(model, factors[k]), 0);
  const offset = sum((model, f) => f * model.offset);
  const weights = Float64Array.from(runs, (_, i) =>
    sum((model, f) => f * model.scale * model.weights[i]) / 3 ** lengths.length);
  const trend = addedTerms(models.map((model) => model.trend),
    models.map((model, k) => factors[k] * model.scale));
  const square = sum((model, f) => f * f * model.variance);
  const centres = new Float64Array(n * lengths.length);
  runs.forEach((row, i) => lengths.forEach((length, j) => {
    centres[i * lengths.length + j] = row[j] * (ROOT5 / length);
  }));
  const product = new Float64Array(n);

  function predict(points, size, mean, variance) {
    const values = columnValues(columns, points, size);
    const power = powersOf(values, size);
    const trendOf = trend.map(([term]) => term.map(([j, q]) => power(j, q)));
    trend.forEach(([, coefficient], t) => addProduct(mean, coefficient, trendOf[t], size));
    const known = variance && keptFor(runs, key, () =>
      factored(runs, centres, trend.map(([term]) => term), nugget));
    const place = new Float64Array(lengths.length);
    for (let i = 0; i < size; i++) {
      for (let j = 0; j < place.length; j++) place[j] = values[j][i] * (ROOT5 / lengths[j]);
      mean[i] += offset + correlate(place, centres, weights, product);
      if (!variance) continue;
      const row = trendOf.map((own) => own.reduce((value, factor) => value * factor[i], 1));
      variance[i] += square * unexplained(known, product, row, nugget, 3 ** lengths.length);
    }
  }
  return Object.assign(predict, { cost: n * lengths.length });
}

// 3^c times the correlations (n,) of a scaled place (c,) with scaled centres, flat (n, c), and
// their sum by weights (n,).
function correlate(place, centres, weights, product) {
  const n = product.length;
  const c = place.length;
  let sum = 0;
  for (let k = 0, at = 0; k < n; k++) {
    let total = 0;
    let value = 1;
    for (let j = 0; j < c; j++, at++) {
      const s = Math.abs(place[j] - centres[at]);
      total += s;
      value *= (s + 3) * s + 3;
    }
    product[k] = value * Math.exp(-total);
    sum += weights[k] * product[k];
  }
  return sum;
}

// Variance of a new run, that of the process being 1; `product` is overwritten.
function unexplained({ lower, solved, gain }, product, row, nugget, unit) {
  const n = product.length;
  const rest = row.map((value, t) => {
    let along = 0;
    for (let k = 0; k < n; k++) along += product[k] * solved[t][k];
    return value - along / unit;
  });
  forward(lower, product, n);
  let explained = 0;
  for (let k = 0; k < n; k++) explained += product[k] * product[k];
  let trended = 0;
  rest.forEach((a, t) => rest.forEach((b, u) => { trended += a * gain[t][u] * b; }));
  return Math.max(1 + nugget + trended - explained / (unit * unit), nugget);
}

// Cholesky factor of the runs' correlations R, R^-1 F and (F' R^-1 F)^-1 of the trend's F.
function factored(runs, centres, terms, nugget) {
  const n = runs.length;
  const c = centres.length / n;
  const unit = 3 ** c;
  const matrix = new Float64Array(n * n);
  for (let i = 0; i < n; i++) {
    const row = matrix.subarray(i * n, (i + 1) * n);
    correlate(centres.subarray(i * c, (i + 1) * c), centres, row, row);
    for (let k = 0; k < n; k++) row[k] /= unit;
    row[i] = 1 + nugget;
  }
  const lower = cholesky(matrix, n);
  const F = terms.map((term) => Float64Array.from(runs, (row) =>
    term.reduce((value, [j, q]) => value * row[j] ** q, 1)));
  const solved = F.map((column) => backward(lower, forward(lower, column.slice(), n), n));
  const product = F.map((a) => solved.map((b) => a.reduce((sum, value, k) => sum + value * b[k], 0)));
  return { lower, solved, gain: inverse(product) };
}

// Of a small positive definite matrix given as rows.
function inverse(rows) {
  const q = rows.length;
  const lower = cholesky(Float64Array.from(rows.flat()), q);
  return rows.map((_, t) => {
    const unit = new Float64Array(q);
    unit[t] = 1;
    return backward(lower, forward(lower, unit, q), q);
  });
}
