// Monte Carlo: how outputs vary when parameters follow their laws.
import { drawn } from "./draws.js";
import { generator } from "./random.js";

const BATCH = 4096;
const BINS = 60;
// Correlations that the means of one output may take, and draws that it has at least.
const BUDGET = 6e8;
const FEWEST = 10000;
// Batches without enough points inside of the constraints before the search for more ends.
const LEAST_SHARE = 1e-3;

// Moments, quantiles, share inside of limits and a histogram of values, which are sorted.
export function summary(values, [low, high]) {
  const n = values.length;
  values.sort();
  let mean = 0;
  for (let i = 0; i < n; i++) mean += values[i];
  mean /= n;
  let square = 0;
  let inside = 0;
  for (let i = 0; i < n; i++) {
    square += (values[i] - mean) ** 2;
    if (values[i] >= low && values[i] <= high) inside++;
  }
  return { n, mean, deviation: Math.sqrt(square / (n - 1)), inside: inside / n,
    quantiles: [0.05, 0.5, 0.95].map((p) => quantileOf(values, p)), ...histogram(values) };
}

// Of sorted values, linear between them.
function quantileOf(values, p) {
  const place = p * (values.length - 1);
  const k = Math.min(Math.floor(place), values.length - 2);
  return values[k] + (place - k) * (values[k + 1] - values[k]);
}

// Counts in even bins; the outermost bins hold the tails beyond 1/2000 at either end.
function histogram(values) {
  const [from, to] = [quantileOf(values, 0.0005), quantileOf(values, 0.9995)];
  const counts = new Float64Array(BINS);
  const scale = to > from ? BINS / (to - from) : 0;
  for (let i = 0; i < values.length; i++) {
    counts[Math.min(Math.max(Math.floor((values[i] - from) * scale), 0), BINS - 1)]++;
  }
  return { from, to, counts: Array.from(counts) };
}

// Columns of points that the study allows, from laws and constraints; fewer where few are.
function* allowedPoints(study, held, draws, random) {
  const { space, free } = study;
  let [tried, kept] = [0, 0];
  while (kept < draws) {
    const size = free ? Math.min(BATCH, draws - kept) : BATCH;
    let points = drawn(study, held, size, random);
    if (!free) {
      const rows = [];
      for (let i = 0; i < size && kept + rows.length < draws; i++) {
        const point = space.completed(points.map((column) => column[i]));
        if (space.excess(point) === 0) rows.push(point);
      }
      points = points.map((_, j) => Float64Array.from(rows, (row) => row[j]));
    }
    tried += size;
    kept += points[0].length;
    if (points[0].length) yield points;
    if (tried > 20 * BATCH && kept < LEAST_SHARE * tried) return;
  }
}

// Summaries of outputs; `pause` lets other work through and says how far this has come.
export async function simulate(study, models, { held, draws, seed, limits }, pause) {
  const random = generator(seed);
  const most = models.map(({ cost }) => Math.min(draws, Math.max(FEWEST, Math.floor(BUDGET / cost))));
  const values = most.map((count) => new Float64Array(count));
  const filled = models.map(() => 0);
  let done = 0;
  let since = performance.now();
  for (const points of allowedPoints(study, held, draws, random)) {
    const size = points[0].length;
    models.forEach((model, k) => {
      const count = Math.min(size, values[k].length - filled[k]);
      if (count <= 0) return;
      values[k].set(model.predict(points, count, false).mean, filled[k]);
      filled[k] += count;
    });
    done += size;
    if (performance.now() - since > 40) {
      await pause(done / draws);
      since = performance.now();
    }
  }
  return models.map((_, k) =>
    (done > 1 ? summary(values[k].subarray(0, filled[k]), limits[k]) : null));
}
