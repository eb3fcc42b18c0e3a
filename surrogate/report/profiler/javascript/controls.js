// The control of one parameter: slider and number field, or a choice of levels.
import { el } from "./elements.js";
import { figure, typed, typedNumber, withUnit } from "./words.js";

const STOPS = 200;

// Values where a slider stops: the allowed ones, or even steps with the ends exact.
function stopsOf({ allowed, ends }) {
  if (allowed) return allowed;
  const [low, high] = ends;
  return Array.from({ length: STOPS + 1 }, (_, k) => (k === STOPS ? high
    : Number((low + (high - low) * k / STOPS).toPrecision(9))));
}

function nearestStop(stops, value) {
  let best = 0;
  stops.forEach((stop, k) => {
    if (Math.abs(stop - value) < Math.abs(stops[best] - value)) best = k;
  });
  return best;
}

export function control(parameter, j, state, dependent) {
  const { name, shown_unit: unit, about, told } = parameter;
  const id = `explore-${j}`;
  const input = parameter.coding.kind === "levels"
    ? levels(parameter, j, state, id) : numbers(parameter, j, state, id, dependent);
  const coded = el("span", { class: "coded" });
  const hold = el("input", { type: "checkbox", id: `${id}-held`, disabled: dependent,
    change: () => state.hold(j, hold.checked) });
  const root = el("div", { class: "control", "data-kind": parameter.coding.kind,
    "data-parameter": name },
    el("label", { for: id, class: "name", title: [about, told].filter(Boolean).join("; ") }, name),
    ...input.elements,
    el("div", { class: "small-line" }, coded,
      dependent ? el("span", {}, "follows")
        : el("label", { class: "hold", for: `${id}-held`,
          title: `Target search and Monte Carlo keep ${name} where it is` }, hold, "hold")));

  function show(value, t) {
    input.show(value);
    coded.textContent = `coded ${Math.abs(t) < 5e-4 ? "0" : figure(t, 3)}`;
    root.classList.toggle("outside", Math.abs(t) > 1 + 1e-9);
    root.dataset.value = String(value);
    root.dataset.shown = typeof value !== "number" ? value
      : withUnit(parameter.allowed ? typed(value) : figure(value), unit);
    root.title = unit ? `${name} in ${unit}` : name;
  }
  return { root, show };
}

function levels({ name, coding }, j, state, id) {
  const choice = el("select", { id, "aria-label": name, change: () => state.set(j, choice.value) },
    ...coding.levels.map((level) => el("option", { value: level }, level)));
  return { elements: [choice], show: (value) => { choice.value = value; } };
}

function numbers(parameter, j, state, id, dependent) {
  const { name, shown_unit: unit, allowed } = parameter;
  const stops = stopsOf(parameter);
  const last = stops.length - 1;
  const slider = el("input", { type: "range", id, min: 0, max: last, step: 1, disabled: dependent,
    input: () => state.set(j, stops[slider.valueAsNumber]),
    keydown: (event) => {
      const pages = { PageUp: 1, PageDown: -1 }[event.key];
      if (!pages) return;
      event.preventDefault();
      const wide = Math.max(1, Math.round(last / 10));
      state.set(j, stops[Math.min(Math.max(slider.valueAsNumber + pages * wide, 0), last)]);
    } });
  const field = el("input", { type: "text", inputmode: "decimal", autocomplete: "off",
    disabled: dependent, "aria-label": withUnit(`${name}, value`, unit && `in ${unit}`),
    change: () => {
      const value = typedNumber(field.value);
      const snapped = allowed ? stops[nearestStop(stops, value)] : value;
      if (Number.isFinite(value)) state.set(j, snapped);
      else show(state.get().values[j]);
    },
    keydown: (event) => {
      const steps = { ArrowUp: 1, ArrowDown: -1 }[event.key];
      if (!steps) return;
      event.preventDefault();
      const k = nearestStop(stops, state.get().values[j]) + steps;
      state.set(j, stops[Math.min(Math.max(k, 0), last)]);
    } });

  function show(value) {
    slider.value = nearestStop(stops, value);
    slider.setAttribute("aria-valuetext", withUnit(allowed ? typed(value) : figure(value), unit));
    field.value = typed(value);
  }
  return { show, elements: [slider,
    el("div", { class: "typed" }, field, unit ? el("span", { class: "unit" }, unit) : null)] };
}
