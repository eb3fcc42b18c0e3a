// The parameters of a study: coded and physical points, and where a prediction extrapolates.
import { encoded, physical } from "../../../portable/javascript/coding.js";
import { columnValues } from "../../../portable/javascript/columns.js";
import { holds, violation } from "./constraints.js";

const EDGE = 1e-9;

export function spaceOf({ parameters, constraints, equalities, clouds }) {
  const dependent = new Set(equalities.map((one) => one.dependent));

  // The allowed value nearest to a physical one, the lower of two.
  function nearest(j, value) {
    const { allowed } = parameters[j];
    if (!allowed || typeof value !== "number") return value;
    return allowed.reduce((best, one) =>
      (Math.abs(one - value) < Math.abs(best - value) ? one : best));
  }

  const decode = (coded) => parameters.map(({ coding }, j) => nearest(j, physical(coding, coded[j])));
  const encode = (values) => Float64Array.from(values, (value, j) =>
    encoded(parameters[j].coding, value));

  // A coded point with allowed values, and dependent parameters that follow from the others.
  function completed(coded) {
    const point = Float64Array.from(coded, (t, j) => (parameters[j].allowed
      || parameters[j].coding.kind === "levels" ? encode1(j, t) : t));
    for (const { dependent: j, constant, coefficients } of equalities) {
      point[j] = coefficients.reduce((sum, c, i) => (i === j ? sum : sum - c * coded[i]), constant);
    }
    return point;
  }

  function encode1(j, t) {
    const { coding } = parameters[j];
    return encoded(coding, nearest(j, physical(coding, t)));
  }

  const outside = (coded) => parameters.flatMap((_, j) =>
    (Math.abs(coded[j]) <= 1 + EDGE ? [] : [j]));

  function broken(coded) {
    const values = decode(coded);
    return constraints.filter((one) => !holds(one, values)).map((one) => one.text);
  }

  // 0 for a point that the study allows.
  function excess(coded) {
    const values = constraints.length ? decode(coded) : [];
    const beyond = coded.reduce((most, t) => Math.max(most, Math.abs(t) - 1 - EDGE), 0);
    return constraints.reduce((most, one) => Math.max(most, violation(one, values)), beyond);
  }

  // Outside of the cloud of rows: Montgomery, Peck and Vining 2012, section 3.8.
  function hidden(coded) {
    const points = Array.from(coded, (t) => Float64Array.of(t));
    return clouds.some(({ columns, directions, sizes, largest }) => {
      const row = [1, ...columnValues(columns, points, 1).map(([value]) => value)];
      const along = directions.map((one) => one.reduce((sum, d, k) => sum + d * row[k], 0));
      const away = row.map((value, k) =>
        Math.abs(along.reduce((rest, a, r) => rest - a * directions[r][k], value)));
      const leverage = along.reduce((sum, a, r) => sum + (a / sizes[r]) ** 2, 0);
      return leverage > largest * (1 + EDGE) || Math.max(...away) > 1e-6;
    });
  }

  const trusted = (coded) => excess(coded) === 0 && !hidden(coded);

  return { parameters, dependent, nearest, decode, encode, completed, outside, broken, excess,
    hidden, trusted };
}
