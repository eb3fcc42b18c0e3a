// What the profiler asks for, worked out from a study's surrogates; knows no page.
import { unpacked } from "../../../portable/javascript/numbers.js";
import { surrogate } from "../../../portable/javascript/surrogate.js";
import { merit, probability } from "./desirability.js";
import { geometryOf } from "./geometry.js";
import { largest } from "./search.js";
import { simulate } from "./simulation.js";
import { spaceOf } from "./space.js";

// Points of a curve.
const POINTS = 41;
// Strips of a map in which forbidden regions are found.
const STRIPS = 110;
// Digits of the values that a search finds.
const DIGITS = 10;
// Coded ends within which a parameter without ends is searched.
const SEARCHED = 0.998;

export function opened(packed) {
  const { shared, ...study } = packed;
  return unpacked(study, shared.map((one) => unpacked(one)));
}

export function engine(data) {
  const space = spaceOf(data);
  const made = new Map();

  // The surrogate of an output, of a field that at one of its places.
  function model(k, place) {
    const key = `${k} ${place}`;
    if (!made.has(key)) made.set(key, surrogate(data.outputs[k].document, place));
    return made.get(key);
  }
  const models = (places) => data.outputs.map((_, k) => model(k, places[k]));

  const columnsOf = (points) => data.parameters.map((_, j) =>
    Float64Array.from(points, (point) => point[j]));

  // A point with one parameter moved, and what follows from it.
  function moved(coded, changes) {
    const point = Float64Array.from(coded);
    for (const [j, t] of changes) point[j] = t;
    return space.completed(point);
  }

  // Physical values with those that follow from the others set.
  function followed(values) {
    if (!space.dependent.size) return values;
    const all = space.decode(space.completed(space.encode(values)));
    return values.map((value, j) => (space.dependent.has(j) ? all[j] : value));
  }

  function places(j) {
    const { allowed, coding, ends } = data.parameters[j];
    if (coding.kind === "levels") return coding.levels;
    if (allowed && allowed.length <= POINTS) return Array.from(allowed);
    const [low, high] = ends;
    const even = Array.from({ length: POINTS }, (_, k) =>
      (k === POINTS - 1 ? high : low + (high - low) * k / (POINTS - 1)));
    return [...new Set(even.map((value) => space.nearest(j, value)))];
  }

  function told({ mean, deviation, half }, from, to) {
    const part = (values) => Array.from(values.subarray(from, to));
    return { mean: part(mean), deviation: part(deviation), half: part(half) };
  }

  // Each output at a point of physical values, and along each parameter from there.
  function profile({ values: asked, places: chosen }) {
    const values = followed(asked);
    const coded = space.encode(values);
    const along = data.parameters.map((parameter, j) => (space.dependent.has(j) ? [] : places(j)));
    const points = [coded];
    along.forEach((own, j) => own.forEach((value) => {
      const at = [...values];
      at[j] = value;
      points.push(moved(coded, [[j, space.encode(at)[j]]]));
    }));
    const columns = columnsOf(points);
    const found = models(chosen).map((one) => one.predict(columns, points.length));
    let from = 1;
    const curves = along.map((own) => {
      const start = from;
      from += own.length;
      return {
        values: own,
        trusted: points.slice(start, from).map((point) => space.trusted(point)),
        outputs: found.map((one) => told(one, start, from)),
      };
    });
    return {
      values,
      coded: Array.from(coded),
      at: found.map((one) => ({ mean: one.mean[0], deviation: one.deviation[0], half: one.half[0] })),
      curves,
      outside: space.outside(coded),
      broken: space.broken(coded),
      hidden: space.hidden(coded),
    };
  }

  // One output over two parameters, (rows of y) x (columns of x), row after row.
  function contour({ values, output, place, x, y, size }) {
    const coded = space.encode(values);
    const grid = (j) => Array.from({ length: size }, (_, k) => {
      const [low, high] = data.parameters[j].ends;
      return low + (high - low) * k / (size - 1);
    });
    const [across, up] = [grid(x), grid(y)];
    const points = up.flatMap((v) => across.map((u) => {
      const at = [...values];
      [at[x], at[y]] = [u, v];
      const own = space.encode(at);
      return moved(coded, [[x, own[x]], [y, own[y]]]);
    }));
    const { mean } = model(output, place).predict(columnsOf(points), points.length, false);
    return { mean, allowed: points.map((point) => space.excess(point) === 0),
      ...cutOut(values, coded, x, y) };
  }

  // What constraints forbid, and what lies outside of the cloud of rows: strips [left, right,
  // bottom, top] in shares of the map.
  function cutOut(values, coded, x, y) {
    const parts = { forbidden: [], far: [] };
    if (!data.constraints.length && !data.clouds.length) return parts;
    const ends = [x, y].map((j) => data.parameters[j].ends);
    for (let row = 0; row < STRIPS; row++) {
      for (let column = 0; column < STRIPS; column++) {
        const at = [...values];
        [x, y].forEach((j, d) => {
          const share = ([column, row][d] + 0.5) / STRIPS;
          at[j] = ends[d][0] + share * (ends[d][1] - ends[d][0]);
        });
        const own = space.encode(at);
        const point = moved(coded, [[x, own[x]], [y, own[y]]]);
        const part = space.excess(point) > 0 ? parts.forbidden : space.hidden(point) ? parts.far : null;
        const last = part?.at(-1);
        if (last && last[2] === row / STRIPS && last[1] === column / STRIPS) {
          last[1] = (column + 1) / STRIPS;
        } else part?.push([column, column + 1, row, row + 1].map((edge) => edge / STRIPS));
      }
    }
    return parts;
  }

  // The point of the largest desirability; parameters that are held stay where they are.
  async function search({ values, places: chosen, held, goals }, pause) {
    const coded = space.encode(values);
    const free = data.parameters.map((_, j) => j)
      .filter((j) => !held[j] && !space.dependent.has(j));
    const asked = goals.flatMap((goal, k) => (goal ? [k] : []));
    const [own, wanted] = [models(chosen), asked.map((k) => goals[k])];
    const placed = (x) => moved(coded, free.map((j, i) => [j, x[i]]));
    const many = (some) => {
      const points = some.map(placed);
      const columns = columnsOf(points);
      const means = asked.map((k) => own[k].predict(columns, points.length, false).mean);
      return points.map((point, i) => {
        const excess = space.excess(point);
        return excess > 0 ? -1e6 * (1 + excess) : merit(wanted, means.map((mean) => mean[i]));
      });
    };
    const ends = free.map((j) => (data.parameters[j].bounded ? [-1, 1] : [-SEARCHED, SEARCHED]));
    const smooth = free.map((j) => !data.parameters[j].allowed
      && data.parameters[j].coding.kind !== "levels");
    const best = await largest(many, ends, smooth, pause);
    const exact = placed(best.point);
    const rounded = space.completed(space.encode(space.decode(exact).map((value, j) =>
      (smooth[free.indexOf(j)] ? Number(value.toPrecision(DIGITS)) : value))));
    const point = space.excess(rounded) > space.excess(exact) ? exact : rounded;
    return { values: space.decode(point).map((value, j) =>
      (smooth[free.indexOf(j)] && point === rounded ? Number(value.toPrecision(DIGITS)) : value)),
    ...judged(point, own, asked, goals),
      allowed: space.excess(point) === 0 };
  }

  // Desirability of a point, and the probability that each goal, and all, are met.
  function judged(point, own, asked, goals) {
    const found = asked.map((k) => {
      const one = own[k].predict(columnsOf([point]), 1);
      const [mean, deviation] = [one.mean[0], one.deviation[0]];
      return { output: k, mean, half: one.half[0],
        probability: probability(goals[k], (limit) => own[k].below(limit, mean, deviation)) };
    });
    return {
      outputs: found,
      merit: merit(asked.map((k) => goals[k]), found.map((one) => one.mean)),
      probability: found.reduce((product, one) => product * one.probability, 1),
    };
  }

  function draw({ values, places: chosen, held, ...asked }, pause) {
    const coded = space.encode(values);
    const study = { ...data, space, free: !data.constraints.length };
    const kept = data.parameters.map((_, j) => (held[j] ? coded[j] : undefined));
    return simulate(study, models(chosen), { ...asked, held: kept }, pause);
  }

  // Places and colours of the scene, and the values that its marks show; fast enough for the page's
  // own thread, where it waits for no other answer.
  const geometry = data.scene && geometryOf(data.scene, data.outputs);
  function scene({ values: asked, field, places: chosen }) {
    const values = followed(asked);
    const coded = space.encode(values);
    const said = data.scene.marks.map(({ output }) => (output === null ? null
      : model(output, chosen[output]).predict(columnsOf([coded]), 1, false).mean[0]));
    return { ...geometry(coded, values, field), said };
  }

  return { space, profile, contour, search, draw, scene };
}
