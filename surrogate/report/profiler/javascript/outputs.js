// The head of one row: an output's value and interval, the place of a field, the axis.
import { el } from "./elements.js";
import { flat, unflat } from "./state.js";
import { decimalsOf, figure, fixed, ticks, withUnit } from "./words.js";

// "32.9 [31.6, 34.2]": the decimals that the interval gives a meaning to.
export function interval(mean, half) {
  const decimals = decimalsOf(half);
  if (!Number.isFinite(half)) return [figure(mean), ""];
  if (!(half > 0)) return [figure(mean), "exact to rounding"];
  return [fixed(mean, decimals), `${fixed(mean - half, decimals)} to ${fixed(mean + half, decimals)}`];
}

export function outputHead(output, k, state) {
  const { shown_unit: unit } = output;
  const value = el("output", { class: "value", "aria-live": "polite" });
  const range = el("span", { class: "range" });
  const axis = el("div", { class: "p-ticks axis-ticks", "aria-hidden": "true" });
  const root = el("div", { class: "answer", "data-output": output.name },
    el("span", { class: "name" }, output.name), value, range,
    output.places ? places(output, k, state) : null, axis);

  function show({ mean, half }, [low, high]) {
    const [number, ends] = interval(mean, half);
    if (value.dataset.number !== number) {
      value.dataset.number = number;
      value.replaceChildren(number, ...(unit ? [" ", el("span", { class: "unit" }, unit)] : []));
    }
    range.textContent = ends;
    Object.assign(root.dataset, { mean: String(mean), low: String(mean - half),
      high: String(mean + half) });
    axis.replaceChildren(...ticks(low, high, 3).map(([y, text]) =>
      el("span", { style: `top:${((high - y) / (high - low) * 100).toFixed(1)}%` }, text)));
  }
  return { root, show };
}

// A choice along each dimension of a field.
function places({ name, places: { axes, shape } }, k, state) {
  const chosen = unflat(state.get().places[k], shape);
  const choices = axes.map((axis, d) => el("label", { class: "place" }, axis.name,
    el("select", { "aria-label": `${axis.name} of ${name}`, change: (event) => {
      chosen[d] = event.target.selectedIndex;
      state.place(k, flat(chosen, shape));
    } }, ...axis.values.map((value, i) =>
      el("option", { selected: i === chosen[d] }, withUnit(short(value), axis.unit))))));
  return el("div", { class: "places" }, ...choices);
}

function short(value) {
  const number = Number(value);
  return value.trim() === "" || Number.isNaN(number) ? value : String(Number(number.toPrecision(5)));
}
