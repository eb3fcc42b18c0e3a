// Coded values in [-1, 1] of physical ones and back, by the `coding` of an input.
import { erf, normalQuantile } from "./normal.js";

// Halves go to the even neighbour, as they do in NumPy.
export function rint(x) {
  return Math.abs(x % 1) === 0.5 ? 2 * Math.round(x / 2) : Math.round(x);
}

export function levelAt(coded, levels) {
  return Math.min(Math.max(rint((coded + 1) / 2 * (levels - 1)), 0), levels - 1);
}

export function encoded(coding, value) {
  switch (coding.kind) {
    case "range": return 2 * (value - coding.low) / (coding.high - coding.low) - 1;
    case "levels": return 2 * coding.levels.indexOf(value) / (coding.levels.length - 1) - 1;
    case "normal": return erf((value - coding.mean) / (coding.std * Math.SQRT2));
    case "lognormal": return value <= 0 ? -1 : erf((Math.log(value) - coding.mu) / (coding.sigma * Math.SQRT2));
    default: throw new Error(`coding ${coding.kind} is unknown`);
  }
}

// Written about the nearer end of a range, so that -1 and 1 give its ends to the last digit.
export function physical(coding, t) {
  switch (coding.kind) {
    case "range": {
      const width = coding.high - coding.low;
      return t < 0 ? coding.low + 0.5 * (t + 1) * width : coding.high - 0.5 * (1 - t) * width;
    }
    case "levels": return coding.levels[levelAt(t, coding.levels.length)];
    case "normal": return coding.mean + coding.std * normalScore(t);
    case "lognormal": return Math.exp(coding.mu + coding.sigma * normalScore(t));
    default: throw new Error(`coding ${coding.kind} is unknown`);
  }
}

function normalScore(t) {
  return t < 0 ? normalQuantile((1 + t) / 2) : -normalQuantile((1 - t) / 2);
}
