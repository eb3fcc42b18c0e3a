// The scene: a solver's geometry, coloured by a field, that follows the parameters and turns.
import { gradient } from "./colours.js";
import { el } from "./elements.js";
import { painter } from "./painting.js";
import { turning } from "./turning.js";
import { figure, ticks, withUnit } from "./words.js";

export function scenePanel(data, state, seenAt) {
  const { scene, outputs } = data;
  if (!scene) return null;
  let [field, visible, found] = [0, false, null];
  const [, azimuth, elevation] = scene.views[0];
  const home = { azimuth, elevation, zoom: 1 };
  const view = { ...home };
  const canvas = el("canvas", { class: "s-canvas", tabindex: 0, role: "application",
    "aria-describedby": "explore-scene-says" });
  const reading = el("output", { class: "s-reading" });
  const says = el("p", { class: "caption", id: "explore-scene-says" });
  const scale = el("div", { class: "s-scale", "aria-hidden": "true" });
  const draw = painter(canvas, scene);
  const colour = () => scene.fields[field] && outputs[scene.fields[field].output];

  // A picture in motion is coarser; the fine one follows when nothing has moved for a while.
  let [waiting, settled] = [false, 0];
  function redraw() {
    if (waiting || !visible || !found) return;
    waiting = true;
    requestAnimationFrame(() => {
      waiting = false;
      show(1);
      refine();
    });
  }
  function refine() {
    clearTimeout(settled);
    settled = setTimeout(() => show(Math.min(Math.max(devicePixelRatio, 1.5), 2)), 150);
  }

  function show(fine) {
    if (!visible || !found) return;
    draw.picture(found, { view, fine, limits: limits(), step: levels()[1] - levels()[0],
      labels: labels() });
    canvas.dataset.fine = String(fine > 1);
  }

  const limits = () => (scene.fields[field] ? [scene.fields[field].low, scene.fields[field].high] : null);
  const levels = () => (limits() ? ticks(...limits(), 7).map(([value]) => value) : [0, 1]);
  const labels = () => scene.marks.map(({ label, output }, k) =>
    (output === null || !found.said ? label
      : `${label} ${withUnit(figure(found.said[k], 3), outputs[output].shown_unit)}`));

  function read(event) {
    const at = draw.readAt(event);
    const words = at && [
      ...(colour() ? [withUnit(figure(at.value, 3), colour().shown_unit)] : []),
      ...at.coordinates.map(({ name, unit, value }) => `${name} ${withUnit(figure(value, 3), unit)}`),
    ];
    reading.textContent = words ? words.join(", ") : "Point at the surface to read it.";
  }

  function tell() {
    const one = colour();
    const parts = [...scene.lines, ...scene.marks].map(({ label }) => label);
    const drawn = parts.length ? ` with ${[...new Set(parts)].join(", ")}` : "";
    const values = found.values && Array.from(found.values);
    const range = values ? ` It is ${figure(Math.min(...values), 3)} to `
      + `${withUnit(figure(Math.max(...values), 3), one.shown_unit)} here.` : "";
    const left = one && scene.fields[field].left_out
      ? ` Small modes, ${withUnit(figure(scene.fields[field].left_out, 2), one.shown_unit)} together (RMS), are left out.` : "";
    says.textContent = `The geometry${one ? `, coloured by ${one.name} of ${one.surrogate}` : ""}${drawn}.${range}`
      + `${left} Places are within ${withUnit(figure(scene.error, 2), scene.unit)} of the solver's.`
      + " Drag or use the arrow keys to turn it; plus and minus zoom, 0 goes back.";
    canvas.setAttribute("aria-label", `Geometry in three dimensions${one ? `, coloured by ${one.name}` : ""}`);
  }

  function bar() {
    const one = colour();
    scale.hidden = !one;
    if (!one) return;
    const [low, high] = limits();
    scale.replaceChildren(el("b", {}, one.name.replaceAll("_", "_\u200b"), ...(one.shown_unit ? [` (${one.shown_unit})`] : [])),
      el("div", { class: "s-bar", style: `background:${gradient}` },
        ...ticks(low, high, 7).map(([value, words]) =>
          el("span", { style: `bottom:${(value - low) / (high - low) * 100}%` }, words))));
  }

  // Work is done once a frame, however often a slider says where it is.
  let asked = false;
  function refresh() {
    if (!visible || asked) return;
    asked = true;
    requestAnimationFrame(() => {
      asked = false;
      const begun = performance.now();
      const { values, places } = state.get();
      found = seenAt({ values, field, places });
      show(1);
      canvas.dataset.milliseconds = String(performance.now() - begun);
      tell();
      refine();
    });
  }

  turning(canvas, view, home, redraw, read);
  const go = (to) => () => {
    Object.assign(view, to);
    redraw();
  };
  const button = (words, to, title) => el("button", { type: "button", click: to, "aria-label": title }, words);
  const choice = scene.fields.length > 1 ? el("label", {}, "Colour", el("select", { change: (event) => {
    field = event.target.selectedIndex;
    bar();
    refresh();
  } }, ...scene.fields.map(({ output }) => el("option", {}, outputs[output].name)))) : null;
  const root = el("div", { class: "scene" },
    el("div", { class: "choices" }, choice,
      el("span", { class: "s-views", role: "group", "aria-label": "Views" },
        ...scene.views.map(([name, a, e]) => button(name, go({ azimuth: a, elevation: e })))),
      el("span", { class: "s-views" },
        button("+", () => go({ zoom: Math.min(view.zoom * 1.2, 8) })(), "Zoom in"),
        button("\u2212", () => go({ zoom: Math.max(view.zoom / 1.2, 0.5) })(), "Zoom out"))),
    el("div", { class: "s-frame" }, canvas, scale), reading, says);
  bar();
  reading.textContent = "Point at the surface to read it.";
  new ResizeObserver(redraw).observe(canvas);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redraw);
  new MutationObserver(redraw).observe(document.documentElement, { attributes: true });
  return { title: "Geometry", root, refresh, shown: (now) => {
    visible = now;
    refresh();
  } };
}
