// Places and colours of a scene at a point; what they are made of is in scene_data.py.
import { amplitudesOf } from "../../../portable/javascript/surrogate.js";

// x_i = sum_k c_k mode_ki with polynomials c_k: an array (points,) a component.
function moved({ powers, coefficients, rows, dimension }, scaled) {
  const terms = powers.map((own) =>
    own.reduce((product, q, a) => product * scaled[a] ** q, 1));
  const places = Array.from({ length: dimension }, () => new Float64Array(rows[0].length));
  coefficients.forEach((own, k) => {
    const factor = terms.reduce((sum, term, t) => sum + own[t] * term, 0);
    places.forEach((component, d) => {
      const mode = rows[k * dimension + d];
      for (let i = 0; i < mode.length; i++) component[i] += factor * mode[i];
    });
  });
  return places;
}

// geometryOf(scene, outputs)(coded, values, field): {surface, lines, marks, values}; field is a number of
// scene.fields, and values are null without one.
export function geometryOf(scene, outputs) {
  const amplitudes = scene.fields.map(({ output, rows }) => {
    const { model } = outputs[output].document;
    return amplitudesOf({ ...model, amplitudes: model.amplitudes.slice(0, rows.length - 1) });
  });

  function coloured(coded, field) {
    if (!scene.fields[field]) return null;
    const [mean, ...modes] = scene.fields[field].rows;
    const values = Float64Array.from(mean);
    amplitudes[field](coded).forEach((factor, k) => {
      const mode = modes[k];
      for (let i = 0; i < mode.length; i++) values[i] += factor * mode[i];
    });
    return values;
  }

  // From -1 to 1 over the range of a parameter; coded where it has levels.
  const scaledOf = (coded, values) => scene.active.map((j, a) => {
    const [low, high] = scene.spans[a];
    return 2 * ((typeof values[j] === "number" ? values[j] : coded[j]) - low) / (high - low) - 1;
  });

  return (coded, values, field) => {
    const scaled = scaledOf(coded, values);
    return {
      surface: moved(scene.surface, scaled),
      lines: scene.lines.map(({ moving }) => moved(moving, scaled)),
      marks: scene.marks.map(({ moving }) => moved(moving, scaled)),
      values: coloured(coded, field),
    };
  };
}
