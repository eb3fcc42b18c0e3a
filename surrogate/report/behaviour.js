"use strict";
// Pointing at a mark says which run it is and lights up that run in every figure;
// a click on a table head sorts; print opens what is folded.
(() => {
  const tip = document.getElementById("tip");
  const runs = JSON.parse(document.getElementById("runs-data").textContent);
  let lit = [];

  function words(mark) {
    const run = mark.dataset.run;
    return [run in runs ? runs[run] : "", mark.dataset.tip || ""].filter(Boolean).join("\n");
  }

  function place(event) {
    const gap = 14;
    const box = tip.getBoundingClientRect();
    const wide = document.documentElement.clientWidth;
    const left = Math.max(6, Math.min(event.clientX + gap, wide - box.width - 6));
    const below = event.clientY + gap;
    const top = below + box.height < window.innerHeight ? below : event.clientY - box.height - gap;
    tip.style.left = `${left}px`;
    tip.style.top = `${Math.max(6, top)}px`;
  }

  function hide() {
    tip.hidden = true;
    lit.forEach((mark) => mark.classList.remove("lit"));
    lit = [];
  }

  // A finger is wider than a mark: take the nearest one within its reach.
  function nearest(event, reach) {
    const drawing = event.target.closest("svg");
    let best = null;
    let least = reach;
    for (const mark of drawing ? drawing.querySelectorAll("[data-run],[data-tip]") : []) {
      const box = mark.getBoundingClientRect();
      const away = Math.hypot(box.x + box.width / 2 - event.clientX,
        box.y + box.height / 2 - event.clientY);
      if (away < least) [best, least] = [mark, away];
    }
    return best;
  }

  function show(event) {
    const mark = event.target.closest("[data-run],[data-tip]")
      || (event.type === "pointerdown" ? nearest(event, 24) : null);
    hide();
    if (!mark) return;
    tip.textContent = words(mark);
    tip.hidden = false;
    const run = mark.dataset.run;
    lit = run === undefined ? [mark]
      : [...document.querySelectorAll(`svg [data-run="${CSS.escape(run)}"]`)];
    lit.forEach((other) => other.classList.add("lit"));
    place(event);
  }

  document.addEventListener("pointerover", show);
  document.addEventListener("pointerdown", show);
  document.addEventListener("scroll", hide, { passive: true });
  document.addEventListener("keydown", (event) => { if (event.key === "Escape") hide(); });

  function key(row, column) {
    const cell = row.cells[column];
    if ("sort" in cell.dataset) {
      const number = Number(cell.dataset.sort);
      return Number.isNaN(number) ? cell.dataset.sort : number;
    }
    return cell.classList.contains("n") ? NaN : cell.textContent;
  }

  function compare(a, b) {
    const missing = (value) => typeof value === "number" && Number.isNaN(value);
    if (missing(a) || missing(b)) return null;
    if (typeof a === "number" && typeof b === "number") return a - b;
    return String(a).localeCompare(String(b), undefined, { numeric: true });
  }

  function sort(table, column, head) {
    const down = head.getAttribute("aria-sort") === "ascending";
    table.querySelectorAll("thead th").forEach((other) => other.removeAttribute("aria-sort"));
    head.setAttribute("aria-sort", down ? "descending" : "ascending");
    const body = table.tBodies[0];
    const rows = [...body.rows].map((row) => [key(row, column), row]);
    rows.sort(([a], [b]) => {
      const order = compare(a, b);
      if (order === null) return Number(Number.isNaN(a)) - Number(Number.isNaN(b));
      return down ? -order : order;
    });
    body.append(...rows.map(([, row]) => row));
  }

  document.querySelectorAll("table.sortable").forEach((table) => {
    table.querySelectorAll("thead th").forEach((head, column) => {
      const button = document.createElement("button");
      button.type = "button";
      button.append(...head.childNodes);
      button.addEventListener("click", () => sort(table, column, head));
      head.append(button);
    });
  });

  let opened = [];
  window.addEventListener("beforeprint", () => {
    opened = [...document.querySelectorAll("details:not([open])")];
    opened.forEach((fold) => { fold.open = true; });
  });
  window.addEventListener("afterprint", () => {
    opened.forEach((fold) => { fold.open = false; });
  });
})();
