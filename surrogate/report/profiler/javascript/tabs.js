// Tabs: one panel is shown at a time; arrow keys move between their heads.
import { el } from "./elements.js";

// parts: [{title, root, shown}]; shown(true) when a panel comes to sight.
export function tabs(parts) {
  const heads = parts.map(({ title }, k) => el("button", { type: "button", role: "tab",
    id: `explore-tab-${k}`, "aria-controls": `explore-panel-${k}`, click: () => open(k),
    keydown: (event) => {
      const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
      if (!step) return;
      event.preventDefault();
      const next = (k + step + parts.length) % parts.length;
      open(next);
      heads[next].focus();
    } }, title));
  const panels = parts.map(({ root }, k) => el("div", { role: "tabpanel",
    id: `explore-panel-${k}`, "aria-labelledby": `explore-tab-${k}` }, root));

  function open(chosen) {
    heads.forEach((head, k) => {
      head.setAttribute("aria-selected", k === chosen);
      head.tabIndex = k === chosen ? 0 : -1;
      panels[k].hidden = k !== chosen;
    });
    parts.forEach(({ shown }, k) => shown?.(k === chosen));
  }

  return { open, root: el("div", { class: "tabs" },
    el("div", { role: "tablist", "aria-label": "More of the profiler" }, ...heads), ...panels) };
}
