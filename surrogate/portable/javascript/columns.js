// Numeric columns of coded points, and products of their powers.
import { levelAt } from "./coding.js";

// One array (size,) a column, of points given as one array a coordinate.
export function columnValues(columns, points, size) {
  return columns.map(({ input, level, levels }) => {
    const coded = points[input];
    if (!levels) return coded;
    const values = new Float64Array(size);
    for (let i = 0; i < size; i++) {
      const at = levelAt(coded[i], levels);
      values[i] = (at === level) - (at === 0);
    }
    return values;
  });
}

// Columns to the powers that the terms need: power(j, q) is an array (size,).
export function powersOf(values, size) {
  const known = values.map((value) => [null, value]);
  return function power(j, q) {
    const own = known[j];
    while (own.length <= q) {
      const next = new Float64Array(size);
      for (let i = 0; i < size; i++) next[i] = own[own.length - 1][i] * own[1][i];
      own.push(next);
    }
    return own[q];
  };
}

// Coefficients of the same product added up: [[powers, coefficient], ...].
export function addedTerms(termLists, factors) {
  const sums = new Map();
  termLists.forEach((terms, k) => terms.forEach(({ powers, degrees, coefficient }) => {
    const term = powers || degrees;
    const key = JSON.stringify(term);
    sums.set(key, [term, (sums.get(key)?.[1] ?? 0) + factors[k] * coefficient]);
  }));
  return [...sums.values()];
}
