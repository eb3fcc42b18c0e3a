// A map of one output over two parameters, with the runs of the designs and what is forbidden.
import { physical } from "../../../portable/javascript/coding.js";
import { segments } from "./contour_lines.js";
import { acrossOf } from "./curves.js";
import { dots, el, line, svg } from "./elements.js";
import { figure, ticks, withUnit } from "./words.js";

const SIZE = 41;

export function contour(data, state, ask, fail) {
  const numeric = data.parameters.map((_, j) => j)
    .filter((j) => data.parameters[j].coding.kind !== "levels");
  if (numeric.length < 2) return null;
  const [x, y] = data.leading.filter((j) => numeric.includes(j));
  const chosen = { output: 0, x, y };
  const selects = {};
  const choice = (title, key, options) => {
    selects[key] = el("select", { change: (event) => choose(key, Number(event.target.value)) },
      ...options.map(([value, words]) =>
        el("option", { value, selected: value === chosen[key] }, words)));
    return el("label", {}, title, selects[key]);
  };

  // The two parameters change places when one is chosen twice.
  function choose(key, value) {
    const old = chosen[key];
    const other = { x: "y", y: "x" }[key];
    chosen[key] = value;
    if (other && chosen[other] === value) {
      chosen[other] = old;
      selects[other].value = old;
    }
    refresh();
  }

  const names = numeric.map((j) => [j, data.parameters[j].name]);
  const canvas = el("canvas", { width: SIZE, height: SIZE, "aria-hidden": "true" });
  const [lines, cut, far, runs, cross] = ["c-lines", "c-cut", "p-far", "c-runs", "c-cross"].map((name) =>
    svg("path", { class: name }));
  const labels = el("div", { class: "c-labels", "aria-hidden": "true" });
  const drawing = svg("svg", { viewBox: "0 0 100 100", preserveAspectRatio: "none", role: "img",
    "aria-label": "Contour, not drawn yet" },
    far, lines, cut, runs, cross);
  const upAxis = el("div", { class: "c-up p-ticks", "aria-hidden": "true" });
  const acrossAxis = el("div", { class: "c-across", "aria-hidden": "true" });
  const caption = el("p", { class: "caption" });
  const root = el("div", { class: "contour" },
    el("div", { class: "choices" },
      choice("Output", "output", data.outputs.map(({ name }, k) => [k, name])),
      choice("across", "x", names), choice("up", "y", names)),
    el("div", { class: "c-frame" }, upAxis,
      el("div", { class: "c-map" }, canvas, drawing, labels), acrossAxis), caption);
  let visible = false;

  drawing.addEventListener("pointerdown", (event) => {
    const box = drawing.getBoundingClientRect();
    const at = [(event.clientX - box.left) / box.width, (box.bottom - event.clientY) / box.height];
    const values = [...state.get().values];
    [chosen.x, chosen.y].forEach((j, d) => {
      const [low, high] = data.parameters[j].ends;
      values[j] = Number((low + at[d] * (high - low)).toPrecision(4));
      const { allowed } = data.parameters[j];
      if (allowed) {
        values[j] = allowed.reduce((best, one) =>
          (Math.abs(one - values[j]) < Math.abs(best - values[j]) ? one : best));
      }
    });
    state.change({ values });
  });

  function refresh() {
    if (!visible) return;
    const { values, places } = state.get();
    const { output, x, y } = chosen;
    ask("contour", { values, output, place: places[output], x, y, size: SIZE })
      .then((found) => draw(found, values)).catch(fail);
  }

  function draw({ mean, allowed, forbidden, far: outside }, values) {
    const inside = mean.filter((_, k) => allowed[k]);
    const shown = inside.length ? inside : mean;
    const [low, high] = [Math.min(...shown), Math.max(...shown)];
    paint(mean, low, high);
    const levels = high > low ? ticks(low, high, 7) : [];
    const drawn = levels.map(([level, words]) => [segments(mean, SIZE, SIZE, level), words]);
    const place = ([c, r]) => [c / (SIZE - 1) * 100, 100 - r / (SIZE - 1) * 100];
    lines.setAttribute("d", drawn.map(([own]) =>
      own.map((pair) => line(pair.map(place))).join("")).join(""));
    labels.replaceChildren(...drawn.flatMap(([own, words]) => {
      if (!own.length) return [];
      const [x, y] = place(own[Math.floor(own.length / 2)][0]);
      return [el("span", { style: `left:${x}%;top:${y}%` }, words)];
    }));
    const strips = (some) => some.map(([left, right, bottom, top]) =>
      `M${100 * left} ${100 - 100 * top}H${100 * right}V${100 - 100 * bottom}H${100 * left}Z`).join("");
    cut.setAttribute("d", strips(forbidden));
    far.setAttribute("d", strips(outside));
    const [px, py] = [data.parameters[chosen.x], data.parameters[chosen.y]];
    const [across, up] = [acrossOf(px), acrossOf(py)];
    const at = ([u, v]) => [across(u), 100 - up(v)];
    runs.setAttribute("d", dots(data.runs.coded.map((coded) =>
      at([physical(px.coding, coded[chosen.x]), physical(py.coding, coded[chosen.y])]))));
    const [x, y] = at([values[chosen.x], values[chosen.y]]);
    cross.setAttribute("d", `M${x} 0V100M0 ${y}H100`);
    axes(px, py);
    const { name, shown_unit: unit } = data.outputs[chosen.output];
    const others = data.parameters.length > 2 ? ", the other parameters as above" : "";
    caption.textContent = `${withUnit(name, unit && `(${unit})`)} over ${px.name} and ${py.name}`
      + `${others}: ${figure(low)} to ${withUnit(figure(high), unit)}. Dots: finished runs.`
      + `${data.constraints.length ? " Grey: constraints forbid it." : ""}`
      + `${data.clouds.length ? " Shaded: outside of the cloud of rows." : ""} Point at the map to go there.`;
    drawing.setAttribute("aria-label", caption.textContent);
  }

  // Shades between the two colours of the page's theme, smoothed by the browser.
  function paint(mean, low, high) {
    const pen = canvas.getContext("2d");
    const image = pen.createImageData(SIZE, SIZE);
    const { color, backgroundColor } = getComputedStyle(canvas);
    const [from, to] = [color, backgroundColor].map((one) => one.match(/[\d.]+/g).map(Number));
    mean.forEach((value, k) => {
      const share = high > low ? Math.min(Math.max((value - low) / (high - low), 0), 1) : 0.5;
      const row = SIZE - 1 - Math.floor(k / SIZE);
      const start = 4 * (row * SIZE + k % SIZE);
      for (let c = 0; c < 3; c++) image.data[start + c] = from[c] + share * (to[c] - from[c]);
      image.data[start + 3] = 255;
    });
    pen.putImageData(image, 0, 0);
  }

  function axes(px, py) {
    const [across, up] = [acrossOf(px), acrossOf(py)];
    upAxis.replaceChildren(...ticks(...py.ends, 5).map(([value, words]) =>
      el("span", { style: `top:${100 - up(value)}%` }, words)),
    el("b", {}, withUnit(py.name, py.shown_unit && `(${py.shown_unit})`)));
    acrossAxis.replaceChildren(...ticks(...px.ends, 4).map(([value, words]) =>
      el("span", { style: `left:${across(value)}%` }, words)),
    el("b", {}, withUnit(px.name, px.shown_unit && `(${px.shown_unit})`)));
  }

  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", refresh);
  new MutationObserver(refresh).observe(document.documentElement, { attributes: true });
  return { title: "Contour", root, refresh, shown: (now) => {
    visible = now;
    refresh();
  } };
}
