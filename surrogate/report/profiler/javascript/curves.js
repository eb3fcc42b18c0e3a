// One cell of the matrix: an output along a parameter, with the band of its 95 % interval.
import { dots, el, line, svg } from "./elements.js";
import { ticks } from "./words.js";

// Where values lie between the left (0) and right (100) edge.
export function acrossOf({ coding, ends }) {
  if (coding.kind === "levels") {
    const { levels } = coding;
    return (value) => (levels.indexOf(value) + 0.5) / levels.length * 100;
  }
  const [low, high] = ends;
  return (value) => (value - low) / (high - low) * 100;
}

// Whether a parameter has few values, which are drawn one by one.
function stepped({ coding, allowed }) {
  return coding.kind === "levels" || Boolean(allowed && allowed.length <= 12);
}

// The same in a panel, where the first and last of few values keep off the edges.
export function placeOf(parameter) {
  const across = acrossOf(parameter);
  return parameter.allowed && stepped(parameter) ? (value) => 4 + 0.92 * across(value) : across;
}

const within = (x) => Math.min(Math.max(x, -20), 120);

export function panel(parameter, output, choose) {
  const across = placeOf(parameter);
  const few = stepped(parameter);
  const part = (className, name = "path") => svg(name, { class: className });
  const [grid, far, band, curve, points] = ["p-grid", "p-far", "p-band", "p-curve", "p-dots"].map(
    (name) => part(name));
  const [upright, level] = [part("p-cross"), part("p-cross")];
  const drawing = svg("svg", { viewBox: "0 0 100 100", preserveAspectRatio: "none",
    "aria-hidden": "true" }, grid, far, band, curve, points, upright, level);
  const words = el("div", { class: "p-ticks", "aria-hidden": "true" });
  const root = el("div", { class: "panel", "data-output": output.name,
    "data-parameter": parameter.name },
  el("span", { class: "p-name", "aria-hidden": "true" }, output.name), drawing, words);

  // Pointing moves the parameter to where the finger is.
  function point(event) {
    const box = drawing.getBoundingClientRect();
    choose(parameter, Math.min(Math.max((event.clientX - box.left) / box.width, 0), 1));
  }
  drawing.addEventListener("pointerdown", (event) => {
    drawing.setPointerCapture(event.pointerId);
    point(event);
  });
  drawing.addEventListener("pointermove", (event) => {
    if (drawing.hasPointerCapture(event.pointerId)) point(event);
  });

  function show(found, values, trusted, now, at, [low, high]) {
    const up = (y) => (high - y) / (high - low) * 100;
    const { mean, half } = found;
    const xs = values.map(across);
    const known = mean.every((_, k) => Number.isFinite(half[k]));
    const edge = (sign) => mean.map((y, k) => [xs[k], up(y + sign * half[k])]);
    const marks = ticks(low, high, 3);
    grid.setAttribute("d", marks.map(([y]) => `M0 ${up(y).toFixed(2)}H100`).join(""));
    if (few) {
      band.setAttribute("d", known ? mean.map((_, k) =>
        line([edge(1)[k], edge(-1)[k]])).join("") : "");
      points.setAttribute("d", dots(mean.map((y, k) => [xs[k], up(y)])));
    } else {
      band.setAttribute("d", known ? `${line([...edge(1), ...edge(-1).reverse()])}Z` : "");
      curve.setAttribute("d", line(mean.map((y, k) => [xs[k], up(y)])));
    }
    far.setAttribute("d", forbidden(xs, trusted));
    const x = across(now);
    upright.setAttribute("d", x >= -1 && x <= 101 ? `M${x.toFixed(2)} 0V100` : "");
    level.setAttribute("d", `M0 ${within(up(at)).toFixed(2)}H100`);
    words.replaceChildren(...marks.map(([y, text]) =>
      el("span", { style: `top:${up(y).toFixed(1)}%` }, text)));
    root.classList.toggle("stepped", few);
  }
  return { root, show };
}

// Stripes over what lies outside of constraints or of the cloud of rows.
function forbidden(xs, trusted) {
  return xs.map((x, k) => {
    if (trusted[k]) return "";
    const left = k ? (xs[k - 1] + x) / 2 : 0;
    const right = k < xs.length - 1 ? (x + xs[k + 1]) / 2 : 100;
    return `M${left.toFixed(2)} 0H${right.toFixed(2)}V100H${left.toFixed(2)}Z`;
  }).join("");
}
