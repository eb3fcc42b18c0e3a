// The profiler. The same script serves as worker, where there is no document.
import { asking } from "./asking.js";
import { chances } from "./chances.js";
import { contour } from "./contour.js";
import { copying } from "./copying.js";
import { el } from "./elements.js";
import { engine, opened } from "./engine.js";
import { goals } from "./goals.js";
import { matrix } from "./matrix.js";
import { scenePanel } from "./scene.js";
import { serving } from "./serving.js";
import { stateOf } from "./state.js";
import { tabs } from "./tabs.js";
import { figure, withUnit } from "./words.js";

function start(root) {
  const { study, textContent: program } = document.currentScript;
  const data = opened(study);
  const state = stateOf(data);
  const ask = asking(program, study);
  const warned = el("p", { class: "where", role: "status" });
  const fail = (error) => {
    warned.className = "where warning";
    warned.textContent = `The profiler stopped: ${error.message}.`;
  };
  const rows = matrix(data, state);
  const aims = goals(data, state, ask, fail);
  const copies = copying(data, state, aims.asked);
  const parts = [scenePanel(data, state, engine(data).scene), contour(data, state, ask, fail), aims,
    chances(data, state, ask, fail)].filter(Boolean);
  const more = tabs(parts);
  root.append(
    el("div", { class: "bar" }, warned, ...copies.buttons,
      el("button", { type: "button", click: state.reset }, "Back to the start"), copies.said),
    copies.shown, rows.root, more.root);

  // Where a prediction is not to be trusted, in words.
  function where({ outside, broken, hidden }) {
    const said = outside.map((j) => {
      const { name, shown_unit: unit, ends } = data.parameters[j];
      const [low, high] = ends.map((end) => figure(end));
      return `${name} is outside of its range, ${low} to ${withUnit(high, unit)}`;
    });
    said.push(...broken.map((one) => `constraint ${one} is broken`));
    if (hidden) said.push("the point lies outside of the cloud of rows");
    return said;
  }

  async function refresh() {
    delete root.dataset.settled;
    const { values, places } = state.get();
    const found = await ask("profile", { values, places });
    rows.show(found);
    const said = where(found);
    warned.className = said.length ? "where warning" : "where";
    warned.textContent = said.length ? `Extrapolation: ${said.join("; ")}.`
      : `Inside of all ranges${data.constraints.length ? " and constraints" : ""}`
        + `${data.clouds.length ? " and of the cloud of rows" : ""}.`;
    root.dataset.settled = "";
    if (found.values.some((value, j) => value !== state.get().values[j])
      && state.get().values === values) Object.assign(state.get(), { values: found.values });
  }

  state.listen((changed) => {
    if (!changed.includes("held")) refresh().catch(fail);
    parts.forEach((one) => one.refresh?.(changed));
  });
  root.hidden = false;
  document.documentElement.classList.add("explored");
  more.open(0);
  refresh().catch(fail);
}

if (typeof document === "undefined") self.onmessage = receiving();
else start(document.getElementById("explore-profiler"));

function receiving() {
  const receive = serving((message) => self.postMessage(message));
  return ({ data }) => receive(data);
}
