// Target search: a goal for each output, and the point that meets them best.
import { el } from "./elements.js";
import { interval } from "./outputs.js";
import { figure, typed, typedNumber, withUnit } from "./words.js";

const GOALS = { none: "no goal", target: "reach", maximise: "maximise", minimise: "minimise",
  limits: "keep within" };
// What the three numbers of a goal mean, and which it has.
const FIELDS = {
  target: ["not below", "target", "not above"],
  maximise: ["unacceptable below", null, "good enough at"],
  minimise: ["good enough at", null, "unacceptable above"],
  limits: ["from", null, "to"],
};
// Share of the output's range over which a limit that is left loses its desirability.
const SOFT = 0.05;

export function goals(data, state, ask, fail) {
  const rows = data.outputs.map((output, k) => row(output, k));
  const button = el("button", { type: "button", class: "act", click: run }, "Search");
  const progress = el("progress", { max: 1, value: 0, hidden: true });
  const said = el("div", { class: "found", "aria-live": "polite" });
  const root = el("div", { class: "goals" },
    el("div", { class: "scroll" }, el("table", {},
      el("thead", {}, el("tr", {}, ...["output", "goal", "where", "weight"].map((word) =>
        el("th", { scope: "col" }, word)))),
      el("tbody", {}, ...rows.map((one) => one.root)))),
    el("div", { class: "choices" }, button, progress), said,
    el("p", { class: "caption" }, "Held parameters stay where they are; the others are free. "
      + "Desirability: Derringer and Suich (1980), weighted geometric mean. Probability: that an "
      + "output has a desirability above 0 (or lies within its limits), given the error of its "
      + "surrogate; errors of different outputs are taken as independent."));

  async function run() {
    const asked = rows.map((one) => one.goal());
    const mistakes = asked.filter((goal) => typeof goal === "string");
    said.replaceChildren();
    if (mistakes.length || !asked.some(Boolean)) {
      said.append(el("p", { class: "warning" }, mistakes.join(" ") || "Choose a goal for an output."));
      return;
    }
    progress.hidden = false;
    try {
      const { values, places, held } = state.get();
      tell(await ask("search", { values, places, held, goals: asked }, (share) => {
        progress.value = share;
      }), asked);
    } catch (error) {
      fail(error);
    } finally {
      progress.hidden = true;
    }
  }

  function tell(found, asked) {
    state.change({ values: found.values });
    const best = found.merit > 0 ? figure(found.merit, 3) : "0: no point meets all goals";
    said.replaceChildren(
      el("p", {}, el("strong", {}, `Desirability ${best}`),
        ` · all goals met with probability ${percent(found.probability)}`
        + `${found.allowed ? "" : " · no point keeps all constraints"}. The sliders stand there.`),
      el("div", { class: "scroll" }, answers(found.outputs)));
    Object.assign(said.dataset, { merit: String(found.merit), probability: String(found.probability),
      goals: JSON.stringify(asked) });
  }

  function answers(outputs) {
    const heads = ["output", "predicted", "95\u202f% interval", "goal met"];
    const row = ({ output, mean, half, probability }) => {
      const [number, ends] = interval(mean, half);
      const { name, shown_unit: unit } = data.outputs[output];
      return el("tr", {}, el("th", { scope: "row" }, name), el("td", {}, withUnit(number, unit)),
        el("td", {}, ends), el("td", {}, percent(probability)));
    };
    return el("table", {},
      el("thead", {}, el("tr", {}, ...heads.map((word) => el("th", { scope: "col" }, word)))),
      el("tbody", {}, ...outputs.map(row)));
  }

  return { title: "Target search", root, asked: () => rows.map((one) => one.goal()) };
}

function percent(share) {
  if (!Number.isFinite(share)) return "unknown";
  return share > 0.999 && share < 1 ? "> 99.9\u202f%" : `${figure(100 * share, 3)}\u202f%`;
}

// One output's line of the table; goal() is a goal, null for none, or what is wrong with it.
function row({ name, shown_unit: unit, low, high }, k) {
  const start = { target: [low, (low + high) / 2, high], maximise: [low, NaN, high],
    minimise: [low, NaN, high], limits: [low, NaN, high] };
  const kind = el("select", { "aria-label": `goal of ${name}`, change: ask },
    ...Object.entries(GOALS).map(([value, words]) => el("option", { value }, words)));
  const fields = [0, 1, 2].map((i) => {
    const input = el("input", { type: "text", inputmode: "decimal", autocomplete: "off",
      id: `explore-goal-${k}-${i}` });
    const label = el("label", { for: input.id });
    return { input, label, cell: el("span", {}, label, input) };
  });
  const weight = el("input", { type: "text", inputmode: "decimal", value: "1", class: "narrow",
    "aria-label": `weight of ${name}` });
  const root = el("tr", { "data-output": name },
    el("th", { scope: "row" }, withUnit(name, unit && `(${unit})`)), el("td", {}, kind),
    el("td", {}, el("div", { class: "fields" }, ...fields.map((one) => one.cell))),
    el("td", {}, weight));

  function ask() {
    const own = FIELDS[kind.value] || [null, null, null];
    fields.forEach(({ input, label, cell }, i) => {
      cell.hidden = own[i] === null;
      label.textContent = own[i] || "";
      if (own[i]) input.value = typed(Number(start[kind.value][i].toPrecision(4)));
    });
    weight.disabled = kind.value === "none";
  }
  ask();

  function goal() {
    if (kind.value === "none") return null;
    const [a, b, c] = fields.map(({ input }) => typedNumber(input.value));
    const given = { kind: kind.value, weight: typedNumber(weight.value), soft: SOFT * (high - low) || 1,
      low: kind.value === "limits" && Number.isNaN(a) ? -Infinity : a, target: b,
      high: kind.value === "limits" && Number.isNaN(c) ? Infinity : c };
    const order = kind.value === "target" ? [given.low, b, given.high] : [given.low, given.high];
    if (order.some((value, i) => Number.isNaN(value) || (i && !(value > order[i - 1])))) {
      return `${name}: the numbers of its goal must rise from left to right.`;
    }
    return given.weight > 0 ? given : `${name}: the weight must be a number above 0.`;
  }
  return { root, goal };
}
