// Student's law with `freedom` degrees of freedom; null stands for the normal law.
import { normalCdf } from "./normal.js";

// ln Gamma(x), x > 0: recurrence up to 10, then Stirling's series (DLMF 5.11.1).
function logGamma(x) {
  let shift = 0;
  for (; x < 10; x++) shift += Math.log(x);
  const square = 1 / (x * x);
  const series = (1 / 12 - square * (1 / 360 - square * (1 / 1260 - square * (1 / 1680
    - square * (1 / 1188 - square * 691 / 360360))))) / x;
  return (x - 0.5) * Math.log(x) - x + 0.9189385332046727418 + series - shift;
}

// Continued fraction of the incomplete beta function (DLMF 8.17.22) by Lentz's method.
function betaFraction(a, b, x) {
  const tiny = 1e-300;
  let c = 1;
  let d = 1 / (1 - (a + b) * x / (a + 1) || tiny);
  let value = d;
  for (let m = 1; m < 1000; m++) {
    let change = 1;
    for (const part of [m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m)),
      -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1))]) {
      d = 1 / (1 + part * d || tiny);
      c = 1 + part / c || tiny;
      change = c * d;
      value *= change;
    }
    if (Math.abs(change - 1) < 1e-15) break;
  }
  return value;
}

// Of x and y = 1 - x, which is given to keep its digits.
function incompleteBeta(a, b, x, y) {
  if (x <= 0 || y <= 0) return x <= 0 ? 0 : 1;
  const front = Math.exp(logGamma(a + b) - logGamma(a) - logGamma(b)
    + a * Math.log(x) + b * Math.log(y));
  return x < (a + 1) / (a + b + 2) ? front * betaFraction(a, b, x) / a
    : 1 - front * betaFraction(b, a, y) / b;
}

// Probability of a value below t.
export function studentCdf(t, freedom) {
  if (freedom === null) return normalCdf(t);
  if (Number.isNaN(t)) return NaN;
  const total = freedom + t * t;
  const tail = 0.5 * incompleteBeta(freedom / 2, 0.5, freedom / total, t * t / total);
  return t > 0 ? 1 - tail : tail;
}
