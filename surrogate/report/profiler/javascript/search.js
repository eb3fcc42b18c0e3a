// The largest value of a function on a box, by differential evolution from several starts
// (Storn and Price 1997), then by simplexes from the best of each (Nelder and Mead 1965).
import { generator } from "./random.js";

const STARTS = 3;
const GENERATIONS = 150;
// Step of a slope, as a share of the box.
const NEAR = 1e-9;
const PRIMES = [2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37, 41, 43, 47, 53, 59, 61, 67, 71];

// Radical inverse of n: the Halton sequence has one prime a coordinate (Halton 1960).
function radical(n, prime) {
  let [value, share] = [0, 1 / prime];
  for (let rest = n; rest > 0; rest = Math.floor(rest / prime)) {
    value += share * (rest % prime);
    share /= prime;
  }
  return value;
}

function startingPoint(n, ends, random) {
  return ends.map(([low, high], j) => low + (high - low)
    * (j < PRIMES.length ? radical(n + 1, PRIMES[j]) : random.uniform()));
}

const clamp = (value, [low, high]) => Math.min(Math.max(value, low), high);

// A child of each member: another member plus a difference of two, crossed with its parent.
function children(members, best, ends, random) {
  const size = members.length;
  const any = () => members[Math.floor(random.uniform() * size)];
  return members.map((parent) => {
    const [a, b, c] = [any(), any(), any()];
    const base = random.uniform() < 0.3 ? best : a;
    const share = 0.4 + 0.5 * random.uniform();
    const always = Math.floor(random.uniform() * ends.length);
    return parent.map((value, j) => (j === always || random.uniform() < 0.9
      ? clamp(base[j] + share * (b[j] - c[j]), ends[j]) : value));
  });
}

async function evolved(many, ends, start, pause) {
  const random = generator(start + 1);
  const size = Math.min(Math.max(10 * ends.length, 20), 100);
  let members = Array.from({ length: size }, (_, n) =>
    startingPoint(start * size + n, ends, random));
  let merits = Array.from(many(members));
  const leader = () => merits.reduce((best, value, k) => (value > merits[best] ? k : best), 0);
  for (let generation = 0; generation < GENERATIONS; generation++) {
    await pause((start + generation / GENERATIONS) / STARTS);
    const young = children(members, members[leader()], ends, random);
    many(young).forEach((value, k) => {
      if (value >= merits[k]) [members[k], merits[k]] = [young[k], value];
    });
    if (Math.max(...merits) - Math.min(...merits) < 1e-13) break;
  }
  return members[leader()];
}

// One simplex from a point; steps are shares of the box.
function simplex(many, start, ends, share) {
  const one = (x) => many([x])[0];
  const inside = (x) => x.map((value, j) => clamp(value, ends[j]));
  let corners = [start, ...ends.map(([low, high], j) => {
    const step = share * (high - low);
    return start.map((value, k) => (k !== j ? value
      : value + step > high ? value - step : value + step));
  })].map((x) => [x, one(x)]);
  for (let turn = 0; turn < 200 * ends.length; turn++) {
    corners.sort((a, b) => b[1] - a[1]);
    const [best, worst] = [corners[0], corners[corners.length - 1]];
    const size = Math.max(...worst[0].map((value, j) => Math.abs(value - best[0][j])));
    if (size < 1e-10 && best[1] - worst[1] < 1e-14) break;
    const middle = best[0].map((_, j) =>
      corners.slice(0, -1).reduce((sum, [x]) => sum + x[j], 0) / (corners.length - 1));
    const along = (t) => {
      const x = inside(middle.map((m, j) => m + t * (m - worst[0][j])));
      return [x, one(x)];
    };
    const reflected = along(1);
    let next = reflected;
    if (reflected[1] > best[1]) {
      const further = along(2);
      if (further[1] > reflected[1]) next = further;
    } else if (reflected[1] <= corners[corners.length - 2][1]) {
      next = along(reflected[1] > worst[1] ? 0.5 : -0.5);
      if (next[1] <= Math.max(worst[1], reflected[1])) {
        corners = corners.map(([x]) => {
          const nearer = x.map((value, j) => best[0][j] + 0.5 * (value - best[0][j]));
          return [nearer, one(nearer)];
        });
        continue;
      }
    }
    corners[corners.length - 1] = next;
  }
  corners.sort((a, b) => b[1] - a[1]);
  return corners[0];
}

// Up the gradient from a point: the ridge of a target, where simplexes grow flat, is a step away.
function climbed(many, [start, height], ends) {
  const width = ends.map(([low, high]) => high - low);
  const near = start.map((_, j) => start.map((value, k) => (k !== j ? value
    : value + NEAR * width[j] * (value > ends[j][1] - NEAR * width[j] ? -1 : 1))));
  const slopes = Array.from(many(near), (value, j) =>
    (value - height) / (near[j][j] - start[j]) * width[j] ** 2);
  const steepest = Math.max(...slopes.map((slope, j) => Math.abs(slope) / width[j]));
  if (!(steepest > 0)) return [start, height];
  const at = (t) => start.map((value, j) => clamp(value + t * slopes[j] / steepest, ends[j]));
  let [low, high] = [0, 0.1];
  let best = [0, height];
  for (let turn = 0; turn < 14; turn++) {
    const steps = Array.from({ length: 11 }, (_, k) => low + (high - low) * k / 10);
    many(steps.map(at)).forEach((value, k) => {
      if (value > best[1]) best = [steps[k], value];
    });
    const step = (high - low) / 10;
    [low, high] = [Math.max(best[0] - step, 0), best[0] + step];
  }
  return [at(best[0]), best[1]];
}

// Where many(points) -> values is largest; ends[j] = [low, high], smooth[j] false for a
// coordinate with steps, which the simplexes leave as it is.
export async function largest(many, ends, smooth, pause) {
  if (!ends.length) return { point: [], value: many([[]])[0] };
  let best = { point: [], value: -Infinity };
  for (let start = 0; start < STARTS; start++) {
    const found = await evolved(many, ends, start, pause);
    const free = ends.map((_, j) => j).filter((j) => smooth[j]);
    const placed = (x) => found.map((value, j) => (smooth[j] ? x[free.indexOf(j)] : value));
    let [point, value] = [found, many([found])[0]];
    for (const share of free.length ? [0.1, 0.01, 0.1, 0.001] : []) {
      const from = free.map((j) => point[j]);
      const [x, height] = simplex((some) => many(some.map(placed)), from,
        free.map((j) => ends[j]), share);
      if (height >= value) [point, value] = [placed(x), height];
      [point, value] = climbed((some) => many(some.map((y) => found.map((old, j) =>
        (smooth[j] ? y[j] : old)))), [point, value], ends);
    }
    if (value > best.value) best = { point, value };
  }
  return best;
}
