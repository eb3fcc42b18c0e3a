// A portable surrogate: mean, standard deviation and 95 % interval at coded points.
import { expansions } from "./chaos.js";
import { processes } from "./gaussian_process.js";
import { polynomials } from "./polynomial.js";
import { inBlocks } from "./sums.js";
import { studentCdf } from "./student.js";

const KINDS = { polynomial: polynomials, chaos: expansions, gaussian_process: processes };

function combination(models, factors) {
  if (!models.length) return () => {};
  return KINDS[models[0].kind](models, factors);
}

// A model and what it has in common with others; mappings in both are joined likewise.
export function completed(common, own) {
  const model = { ...common, ...own };
  for (const [key, value] of Object.entries(own)) {
    if (isMapping(value) && isMapping(common[key])) model[key] = completed(common[key], value);
  }
  return model;
}

function isMapping(value) {
  return typeof value === "object" && value !== null && !ArrayBuffer.isView(value)
    && !Array.isArray(value);
}

// Of a field (of any shape, flattened in C order) the value at one place: its modes are
// independent, and what they leave out adds to the variance.
function atPlace(model, place) {
  const amplitudes = model.amplitudes.map((own) => completed(model.common ?? {}, own));
  const modes = combination(amplitudes, model.modes.map((mode) => mode[place]));
  const add = (points, size, mean, variance) => {
    modes(points, size, mean, variance);
    for (let i = 0; i < size; i++) {
      mean[i] += model.mean[place];
      if (variance) variance[i] += model.left_out[place] ** 2;
    }
  };
  return Object.assign(add, { cost: modes.cost });
}

// Means of the amplitudes of a field's modes, (modes,), at a coded point.
export function amplitudesOf(model) {
  const own = model.amplitudes.map((one) =>
    combination([completed(model.common ?? {}, one)], [1]));
  return (coded) => {
    const points = Array.from(coded, (t) => Float64Array.of(t));
    return own.map((add) => {
      const mean = new Float64Array(1);
      add(points, 1, mean, null);
      return mean[0];
    });
  };
}

// The surrogate of a document whose numbers are unpacked; `place` matters to a field only.
//   predict(points, size, spread)  {mean, deviation, half} of points given as one array (size,)
//                                  a coordinate; without `spread` only the mean
//   cost                           correlations of one coordinate that a mean takes
//   below(limit, mean, deviation)  probability of a value below the limit, given the error
export function surrogate(document, place = 0) {
  const { model, error } = document;
  const own = error.kind === "own";
  const at = (value) => (typeof value === "object" && value !== null ? value[place] : value) ?? NaN;
  const add = model.kind === "field" ? atPlace(model, place) : combination([model], [1]);

  function predict(points, size, spread = true) {
    const mean = new Float64Array(size);
    const variance = new Float64Array(spread && own ? size : 0);
    inBlocks(points, size, (block, count, start) => add(block, count,
      mean.subarray(start, start + count),
      variance.length ? variance.subarray(start, start + count) : null));
    if (!spread) return { mean };
    const deviation = own ? variance.map(Math.sqrt) : mean.map(() => at(error.deviation));
    const half = own ? deviation.map((std) => std * (error.quantile_95 ?? NaN))
      : mean.map(() => at(error.half_width_95));
    return { mean, deviation, half };
  }

  function below(limit, mean, deviation) {
    const scale = own ? deviation : deviation * Math.sqrt(1 + 1 / (error.freedom + 1));
    return studentCdf((limit - mean) / scale, error.freedom);
  }

  return { predict, below, cost: add.cost ?? 0 };
}
