// Mean and standard deviation of a document's output at one physical point.
import { encoded, levelAt } from "./coding.js";
import { unpacked } from "./numbers.js";
import { completed, surrogate } from "./surrogate.js";

// The coded value of one input; a level is given by its number or by its name.
function coded({ name, coding }, value) {
  const levels = coding.kind === "levels" ? coding.levels : null;
  if (levels && typeof value === "number") {
    return 2 * levelAt(2 * value / (levels.length - 1) - 1, levels.length) / (levels.length - 1) - 1;
  }
  if (levels ? !levels.includes(value) : typeof value !== "number") {
    const allowed = levels ? `one of ${levels.join(", ")}` : "a number";
    throw new TypeError(`${name}: ${value} must be ${allowed}`);
  }
  return encoded(coding, value);
}

// One array (1,) a coordinate, of an array in the order of the inputs or an object by names.
function place(inputs, x) {
  const length = Array.isArray(x) || ArrayBuffer.isView(x) ? x.length : undefined;
  if (length !== undefined && length !== inputs.length) {
    throw new TypeError(`${length} values; give ${inputs.map(({ name }) => name).join(", ")}`);
  }
  return inputs.map((input, i) =>
    Float64Array.of(coded(input, length === undefined ? x[input.name] : x[i])));
}

// Of a field all places (in C order) from amplitudes that are worked out once.
function ofField({ model, error }) {
  const amplitudes = model.amplitudes.map((own) =>
    surrogate({ model: completed(model.common ?? {}, own), error }));
  const sum = (of, start) => Array.from(model.mean, (_, i) =>
    amplitudes.reduce((total, _, k) => total + of(k, i), start(i)));
  function mean(at) {
    const a = amplitudes.map((one) => one.predict(at, 1, false).mean[0]);
    return sum((k, i) => a[k] * model.modes[k][i], (i) => model.mean[i]);
  }
  function deviation(at) {
    if (error.kind !== "own") return Array.from(error.deviation, (value) => value ?? NaN);
    const s = amplitudes.map((one) => one.predict(at, 1).deviation[0]);
    return sum((k, i) => (s[k] * model.modes[k][i]) ** 2, (i) => model.left_out[i] ** 2)
      .map(Math.sqrt);
  }
  return { mean, deviation };
}

// {mean(x), deviation(x)} of a document whose numbers are packed, with what it shares.
export function atPoint(packed, shared) {
  const whole = unpacked(packed, shared.map((one) => unpacked(one)));
  const inputs = whole.inputs;
  if (whole.model.kind === "field") {
    const { mean, deviation } = ofField(whole);
    return { mean: (x) => mean(place(inputs, x)), deviation: (x) => deviation(place(inputs, x)) };
  }
  const one = surrogate(whole);
  return {
    mean: (x) => one.predict(place(inputs, x), 1, false).mean[0],
    deviation: (x) => one.predict(place(inputs, x), 1).deviation[0],
  };
}
