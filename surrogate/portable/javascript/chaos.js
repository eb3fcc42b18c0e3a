// Polynomial chaos: sums of products of orthonormal functions of one input each.
import { levelAt } from "./coding.js";
import { addedTerms } from "./columns.js";
import { addProduct } from "./sums.js";

// sum_k factors[k] * (expansion k); an expansion has no standard deviation of its own.
export function expansions(models, factors) {
  const { bases } = models[0];
  const terms = addedTerms(models.map((model) => model.terms), factors);
  const highest = bases.map((_, j) =>
    Math.max(0, ...terms.flatMap(([term]) => term.filter(([i]) => i === j).map(([, q]) => q))));
  return function predict(points, size, mean, variance) {
    const values = bases.map((one, i) =>
      (highest[i] ? functions(one, points[i], size, highest[i]) : []));
    terms.forEach(([term, coefficient]) =>
      addProduct(mean, coefficient, term.map(([i, q]) => values[i][q]), size));
    if (variance) variance.fill(NaN);
  };
}

// P_0 (null: it is 1), P_1, ... up to the highest that is needed, each (size,).
function functions(one, coded, size, highest) {
  return one.levels ? contrasts(one, coded, size, highest) : recurrence(one, coded, size, highest);
}

function contrasts({ levels, values }, coded, size, highest) {
  const at = Array.from({ length: size }, (_, i) => levelAt(coded[i], levels));
  return Array.from({ length: highest + 1 }, (_, q) =>
    (q ? Float64Array.from(at, (index) => values[q][index]) : null));
}

// beta[k+1] P_{k+1} = (x - alpha[k]) P_k - beta[k] P_{k-1}.
function recurrence({ alpha, beta }, coded, size, highest) {
  let before = new Float64Array(size);
  let now = new Float64Array(size).fill(1);
  const found = [null];
  for (let k = 0; k < highest; k++) {
    const next = new Float64Array(size);
    for (let i = 0; i < size; i++) {
      next[i] = ((coded[i] - alpha[k]) * now[i] - beta[k] * before[i]) / beta[k + 1];
    }
    found.push(next);
    [before, now] = [now, next];
  }
  return found;
}
