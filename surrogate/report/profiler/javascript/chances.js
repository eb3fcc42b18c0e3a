// Monte Carlo: distributions of the outputs when the parameters that are not held vary.
import { el, svg } from "./elements.js";
import { figure, fixed, decimalsOf, ticks, typedNumber, withUnit } from "./words.js";

const DRAWS = 100000;
const PATIENCE = 150;

export function chances(data, state, ask, fail) {
  const cards = data.outputs.map((output) => card(output, later));
  const progress = el("progress", { max: 1, value: 0, hidden: true, "aria-label": "drawing" });
  const said = el("p", { class: "caption", "aria-live": "polite" });
  const root = el("div", { class: "chances" }, progress,
    el("div", { class: "cards" }, ...cards.map((one) => one.root)), said);
  let visible = false;
  let waiting = null;

  function later() {
    clearTimeout(waiting);
    if (visible) waiting = setTimeout(run, PATIENCE);
  }

  async function run() {
    const { values, places, held } = state.get();
    delete root.dataset.settled;
    try {
      const found = await ask("draw", { values, places, held, draws: DRAWS, seed: 1,
        limits: cards.map((one) => one.limits()) }, (share) => {
        progress.hidden = false;
        progress.value = share;
      });
      found.forEach((own, k) => cards[k].show(own));
      told(found, held);
      root.dataset.settled = "";
    } catch (error) {
      fail(error);
    }
    progress.hidden = true;
  }

  function told(found, held) {
    const kept = data.parameters.filter((_, j) => held[j]).map((one) => one.name);
    const counts = [...new Set(found.map((own) => (own ? own.n : 0)))].sort((a, b) => b - a);
    const count = counts.map((n) => String(n).replace(/\B(?=(\d{3})+$)/g, "\u202f")).join(" or ");
    said.textContent = counts[0] ? `${count} points by the laws of the study, `
      + `${kept.length ? `${kept.join(", ")} held where the sliders stand` : "no parameter held"}`
      + `${data.correlation ? ", correlations kept" : ""}`
      + `${data.constraints.length ? ", constraints kept" : ""}. Values are the surrogates' `
      + "predictions; their own error comes on top." : "No point keeps the constraints.";
  }

  return { title: "Monte Carlo", root, refresh: later, shown: (now) => {
    visible = now;
    later();
  } };
}

// Histogram, moments, quantiles and the share within limits of one output.
function card({ name, shown_unit: unit }, changed) {
  const limit = (words) => el("input", { type: "text", inputmode: "decimal", class: "narrow",
    "aria-label": `${words} limit of ${name}`, placeholder: "none", change: changed });
  const [from, to] = [limit("lower"), limit("upper")];
  const [bars, inside, mark] = ["h-bars", "h-inside", "h-mark"].map((c) => svg("path", { class: c }));
  const axis = el("div", { class: "c-across", "aria-hidden": "true" });
  const drawing = svg("svg", { viewBox: "0 0 100 100", preserveAspectRatio: "none", role: "img",
    "aria-label": "Histogram, not drawn yet" },
    bars, inside, mark);
  const facts = el("dl", {});
  const root = el("div", { class: "card", "data-output": name },
    el("h4", {}, withUnit(name, unit && `(${unit})`)), el("div", { class: "h-frame" }, drawing, axis),
    facts, el("div", { class: "limits" }, "within", from, "to", to));

  function limits() {
    const [low, high] = [typedNumber(from.value), typedNumber(to.value)];
    return [Number.isNaN(low) ? -Infinity : low, Number.isNaN(high) ? Infinity : high];
  }

  function show(own) {
    if (!own) {
      facts.replaceChildren();
      return;
    }
    const { mean, deviation, quantiles, counts, from: low, to: high } = own;
    const tallest = Math.max(...counts);
    const step = 100 / counts.length;
    const bar = (k) => `M${(k * step).toFixed(2)} 100V${(100 - 96 * counts[k] / tallest).toFixed(2)}`
      + `h${step.toFixed(2)}V100Z`;
    const [least, most] = limits();
    const middle = (k) => low + (k + 0.5) / counts.length * (high - low);
    const within = (k) => middle(k) >= least && middle(k) <= most;
    const all = counts.map((_, k) => k);
    bars.setAttribute("d", all.filter((k) => !within(k)).map(bar).join(""));
    inside.setAttribute("d", all.filter(within).map(bar).join(""));
    const x = high > low ? (mean - low) / (high - low) * 100 : 50;
    mark.setAttribute("d", `M${x.toFixed(2)} 0V100`);
    axis.replaceChildren(...(high > low ? ticks(low, high, 4) : []).map(([value, words]) =>
      el("span", { style: `left:${(value - low) / (high - low) * 100}%` }, words)));
    const decimals = decimalsOf(deviation) + 1;
    const rows = [["mean", fixed(mean, decimals)], ["sd", figure(deviation, 3)],
      ...[5, 50, 95].map((p, k) => [`${p}\u202f%`, fixed(quantiles[k], decimals)])];
    if (least > -Infinity || most < Infinity) {
      rows.push(["within limits", `${figure(100 * own.inside, 3)}\u202f%`]);
    }
    facts.replaceChildren(...rows.map(([words, value]) =>
      el("div", {}, el("dt", {}, words), el("dd", {}, value))));
    drawing.setAttribute("aria-label", `Histogram of ${name}: mean ${fixed(mean, decimals)}, `
      + `standard deviation ${figure(deviation, 3)}`);
    Object.assign(root.dataset, { mean: String(mean), deviation: String(deviation),
      quantiles: quantiles.join(" "), inside: String(own.inside) });
  }
  return { root, show, limits };
}
