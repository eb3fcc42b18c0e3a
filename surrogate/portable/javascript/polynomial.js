// Polynomials in columns, with the standard deviation of a new observation,
// s sqrt(1 + x' (X'X)^-1 x) (Montgomery, Peck and Vining 2012, equation 3.54).
import { forward, lowerOfColumns } from "./algebra.js";
import { addedTerms, columnValues, powersOf } from "./columns.js";
import { keptFor } from "./kept.js";
import { addProduct } from "./sums.js";

// sum_k factors[k] * (model k), and the variance of the sum: they share columns and runs.
export function polynomials(models, factors) {
  const { columns, deviation } = models[0];
  const terms = addedTerms(models.map((model) => model.terms), factors);
  const known = models.every((model) => model.deviation);
  const square = known ? models.reduce((sum, model, k) =>
    sum + (factors[k] * (model.deviation.residual_sd ?? NaN)) ** 2, 0) : NaN;
  return function predict(points, size, mean, variance) {
    const power = powersOf(columnValues(columns, points, size), size);
    const factorsOf = (term) => term.map(([j, q]) => power(j, q));
    terms.forEach(([term, coefficient]) => addProduct(mean, coefficient, factorsOf(term), size));
    if (!variance) return;
    if (!known || Number.isNaN(square)) {
      variance.fill(NaN);
      return;
    }
    const lower = lowerFactor(columns, deviation);
    const values = deviation.terms.map(factorsOf);
    const row = new Float64Array(values.length);
    for (let i = 0; i < size; i++) {
      for (let t = 0; t < row.length; t++) {
        row[t] = values[t].reduce((product, value) => product * value[i], 1);
      }
      forward(lower, row, row.length);
      variance[i] += square * (1 + row.reduce((sum, part) => sum + part * part, 0));
    }
  };
}

// The triangle of the training rows, made once for all models of the same runs and terms.
function lowerFactor(columns, { points, terms }) {
  return keptFor(points, JSON.stringify(terms), () => {
    const size = points.length;
    const coordinates = Array.from(points[0], (_, j) => Float64Array.from(points, (row) => row[j]));
    const power = powersOf(columnValues(columns, coordinates, size), size);
    return lowerOfColumns(terms.map((term) => {
      const column = new Float64Array(size);
      addProduct(column, 1, term.map(([j, q]) => power(j, q)), size);
      return column;
    }));
  });
}
