// The matrix: one row an output, one column a parameter with its control below.
import { control } from "./controls.js";
import { panel, placeOf } from "./curves.js";
import { el } from "./elements.js";
import { outputHead } from "./outputs.js";
import { typed } from "./words.js";

export function matrix(data, state) {
  const { parameters, outputs } = data;
  const dependent = new Set(data.equalities.map((one) => one.dependent));
  const heads = outputs.map((output, k) => outputHead(output, k, state));
  const controls = parameters.map((parameter, j) =>
    control(parameter, j, state, dependent.has(j)));
  const panels = parameters.map((parameter, j) => outputs.map((output) =>
    panel(parameter, output, (_, share) => choose(j, share))));
  const spans = outputs.map(() => null);
  const root = el("div", { class: "matrix", role: "group", "aria-label": "Prediction profiler",
    style: `--columns:${parameters.length}` },
  el("div", { class: "column heads" }, ...heads.map((head) => head.root)),
  ...parameters.map((parameter, j) => el("div", { class: "column" },
    el("div", { class: "panels" }, ...panels[j].map((one) => one.root)),
    el("div", { class: "p-axis", "data-kind": parameter.coding.kind,
      "aria-hidden": "true" }, ...axis(parameter)),
    controls[j].root)));

  // The value at a share of the width of a panel.
  function choose(j, share) {
    if (dependent.has(j)) return;
    const parameter = parameters[j];
    const { allowed, coding, ends } = parameter;
    if (coding.kind === "levels" || allowed) {
      const own = Array.from(allowed || coding.levels);
      const away = (value) => Math.abs(placeOf(parameter)(value) - 100 * share);
      state.set(j, own.reduce((best, value) => (away(value) < away(best) ? value : best)));
    } else state.set(j, Number((ends[0] + share * (ends[1] - ends[0])).toPrecision(4)));
  }

  // The scale of a row: what the output has been, and all that the curves have shown of it.
  function spanOf(k, { at, curves }) {
    const seen = [at[k].mean];
    for (const curve of curves) {
      const { mean, half } = curve.outputs[k];
      mean.forEach((y, i) => {
        const width = Number.isFinite(half[i]) ? half[i] : 0;
        seen.push(y - width, y + width);
      });
    }
    const [low, high] = [Math.min(...seen), Math.max(...seen)];
    const old = spans[k];
    const place = state.get().places[k];
    const kept = old && old.place === place ? [Math.min(low, old.low), Math.max(high, old.high)]
      : [low, high];
    if (!old || old.place !== place || kept[0] < old.low || kept[1] > old.high) {
      const room = 0.04 * (kept[1] - kept[0]) || Math.abs(kept[0]) * 0.1 || 0.5;
      spans[k] = { low: kept[0] < old?.low || !old || old.place !== place ? kept[0] - room : old.low,
        high: kept[1] > old?.high || !old || old.place !== place ? kept[1] + room : old.high, place };
    }
    return [spans[k].low, spans[k].high];
  }

  function show(found) {
    outputs.forEach((_, k) => {
      const span = spanOf(k, found);
      heads[k].show(found.at[k], span);
      parameters.forEach((_, j) => {
        const { values, trusted, outputs: own } = found.curves[j];
        if (own[k].mean.length) {
          panels[j][k].show(own[k], values, trusted, found.values[j], found.at[k].mean, span);
        }
      });
    });
    showControls(found.values, found.coded);
  }

  const showControls = (values, coded) =>
    controls.forEach((one, j) => one.show(values[j], coded[j]));

  return { root, show, showControls };
}

// Ends of a scale, or the levels.
function axis({ coding, ends }) {
  const words = coding.kind === "levels" ? coding.levels : ends.map((end) => typed(Number(end.toPrecision(3))));
  return Array.from(words, (word) => el("span", { title: word }, word));
}
