"use strict";
// Pointing at a mark says which run it is and lights up that run in every figure; a click on a
// table head sorts; an output is chosen; figures are downloaded; print opens what is folded.
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

  // One output is looked at; the others' verdicts are hidden, and print shows them all.
  const choices = [...document.querySelectorAll(".outputs input")];
  function choose(input) {
    input.checked = true;
    choices.forEach((other) => {
      other.closest("tr").classList.toggle("chosen", other === input);
      document.getElementById(`verdict-${other.value}`).hidden = other !== input;
    });
  }
  choices.forEach((input) => {
    input.addEventListener("change", () => choose(input));
    input.closest("tr").addEventListener("click", () => { choose(input); input.focus(); });
  });
  const first = choices.find((input) => input.checked);
  if (first) choose(first);

  // A frame is a stop of the keyboard only while something in it can be scrolled to.
  const frames = new ResizeObserver((entries) => entries.forEach(({ target }) => {
    const aside = target.scrollWidth > target.clientWidth + 1;
    const over = aside || target.scrollHeight > target.clientHeight + 1;
    target.classList.toggle("over", over);
    target.classList.toggle("aside", aside);
    if (over) target.tabIndex = 0;
    else target.removeAttribute("tabindex");
  }));
  document.querySelectorAll(".scroll").forEach((frame) => frames.observe(frame));

  // Light, dark, or as the system has it.
  const theme = document.getElementById("theme");
  const root = document.documentElement;
  const dark = matchMedia("(prefers-color-scheme: dark)");
  const isDark = () => (root.style.colorScheme || (dark.matches ? "dark" : "light")) === "dark";
  const name = () => { theme.textContent = isDark() ? "Light" : "Dark"; };
  theme.hidden = false;
  theme.addEventListener("click", () => {
    root.style.colorScheme = isDark() ? "light" : "dark";
    name();
  });
  dark.addEventListener("change", name);
  name();

  // A drawing by itself: styles written into it, light, on white.
  const STYLES = ["fill", "fill-opacity", "stroke", "stroke-width", "stroke-dasharray", "opacity",
    "filter", "font-family", "font-size", "font-weight", "text-anchor", "image-rendering"];
  const USUAL = { "fill-opacity": "1", opacity: "1", filter: "none", "stroke-dasharray": "none",
    "font-weight": "400", "text-anchor": "start", "image-rendering": "auto", stroke: "none" };
  function standalone(figure) {
    const drawn = figure.querySelector(".drawn svg");
    const copy = drawn.cloneNode(true);
    const before = root.style.colorScheme;
    root.style.colorScheme = "light";
    const originals = drawn.querySelectorAll("g *");
    copy.querySelectorAll("g *").forEach((mark, k) => {
      const style = getComputedStyle(originals[k]);
      const words = STYLES.map((key) => [key, style.getPropertyValue(key)])
        .filter(([key, value]) => value !== USUAL[key]
          && (mark.tagName === "text" || !/^(font|text)/.test(key)));
      mark.style.cssText += words.map(([key, value]) => `${key}:${value}`).join(";");
      ["class", "data-tip", "data-run"].forEach((key) => mark.removeAttribute(key));
    });
    root.style.colorScheme = before;
    const [, , width, height] = copy.getAttribute("viewBox").split(" ").map(Number);
    const edge = 8;
    const wide = width + 2 * edge;
    const high = height + 2 * edge;
    const words = { xmlns: drawn.namespaceURI, width: wide, height: high,
      viewBox: `${-edge} ${-edge} ${wide} ${high}` };
    Object.entries(words).forEach(([key, value]) => copy.setAttribute(key, value));
    copy.removeAttribute("style");
    const paper = document.createElementNS(words.xmlns, "rect");
    Object.entries({ x: -edge, y: -edge, width: wide, height: high, fill: "#fff" })
      .forEach(([key, value]) => paper.setAttribute(key, value));
    copy.insertBefore(paper, copy.querySelector("g"));
    return { text: new XMLSerializer().serializeToString(copy), wide, high };
  }

  function save(figure, blob, ending) {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(blob);
    link.download = `${figure.dataset.file}.${ending}`;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  }

  function plain(cell) {
    const words = cell.textContent.trim();
    if (cell.tagName === "TH" || cell.classList.contains("w"))
      return /[",\n]/.test(words) ? `"${words.replaceAll('"', '""')}"` : words;
    const raised = (power) => [...power].map((sign) => "⁰¹²³⁴⁵⁶⁷⁸⁹".indexOf(sign))
      .map((digit) => (digit < 0 ? "-" : digit)).join("");
    return words === "–" ? "" : words.replace(/[\s\u202f]/g, "").replace("−", "-")
      .replace(/×10([⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+)/, (_, power) => `e${raised(power)}`);
  }

  const DOWNLOADS = {
    SVG: (figure) => {
      const { text } = standalone(figure);
      save(figure, new Blob([text], { type: "image/svg+xml" }), "svg");
    },
    PNG: (figure) => {
      const { text, wide, high } = standalone(figure);
      const picture = new Image();
      picture.onload = () => {
        const canvas = document.createElement("canvas");
        [canvas.width, canvas.height] = [2 * wide, 2 * high];
        canvas.getContext("2d").drawImage(picture, 0, 0, canvas.width, canvas.height);
        canvas.toBlob((blob) => save(figure, blob, "png"), "image/png");
      };
      picture.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(text)}`;
    },
    CSV: (figure) => {
      const rows = [...figure.querySelector(".numbers").rows];
      const text = rows.map((row) => [...row.cells].map(plain).join(",")).join("\r\n");
      save(figure, new Blob(["\ufeff", text, "\r\n"], { type: "text/csv" }), "csv");
    },
  };
  document.querySelectorAll(".plot").forEach((figure) => {
    const title = figure.querySelector("title").textContent;
    figure.querySelector("summary").setAttribute("aria-label", `Numbers of ${title}`);
    const tools = figure.querySelector(".tools");
    Object.entries(DOWNLOADS).forEach(([kind, get]) => {
      const button = document.createElement("button");
      button.type = "button";
      button.textContent = kind;
      button.setAttribute("aria-label", `${kind} of ${title}`);
      button.addEventListener("click", () => get(figure));
      tools.append(button);
    });
  });

  // The contents show where the reader is.
  const entries = new Map([...document.querySelectorAll("nav > ul > li")]
    .map((entry) => [entry.querySelector("a").hash.slice(1), entry]));
  const seen = new IntersectionObserver((changes) => changes.forEach((change) => {
    const entry = entries.get(change.target.id);
    if (entry) entry.classList.toggle("here", change.isIntersecting);
  }), { rootMargin: "-20% 0px -79% 0px" });
  document.querySelectorAll("main > section").forEach((section) => seen.observe(section));

  // On paper everything is open, and a table wider than the page is set in parts,
  // each of which begins with the first column.
  const PAGE = { wide: 1500, narrow: 840 }; // px on the screen that fit a page in its smaller type
  function parts(table, room) {
    table.style.width = "min-content";
    const widths = [...table.tHead.rows[0].cells].map((head) => head.offsetWidth);
    table.style.width = "";
    const groups = [[]];
    let used = widths[0];
    widths.slice(1).forEach((width, k) => {
      if (used + width > room && groups.at(-1).length) {
        groups.push([]);
        used = widths[0];
      }
      groups.at(-1).push(k + 1);
      used += width;
    });
    return groups;
  }
  function inParts(table) {
    const room = table.closest(".table.wide") ? PAGE.wide : PAGE.narrow;
    const groups = parts(table, room);
    if (groups.length < 2) return;
    groups.reverse().forEach((columns) => {
      const part = table.cloneNode(false);
      part.classList.add("part");
      [table.tHead, ...table.tBodies].forEach((old) => {
        const body = old.cloneNode(false);
        [...old.rows].forEach((row) => {
          const line = row.cloneNode(false);
          [0, ...columns].forEach((k) => line.append(row.cells[k].cloneNode(true)));
          body.append(line);
        });
        part.append(body);
      });
      table.after(part);
    });
    table.classList.add("whole");
  }
  let opened = [];
  window.addEventListener("beforeprint", () => {
    opened = [...document.querySelectorAll("details:not([open], .behind)")];
    opened.forEach((fold) => { fold.open = true; });
    document.querySelectorAll(".scroll > table:not(.numbers)").forEach(inParts);
  });
  window.addEventListener("afterprint", () => {
    opened.forEach((fold) => { fold.open = false; });
    document.querySelectorAll("table.part").forEach((part) => part.remove());
    document.querySelectorAll("table.whole").forEach((table) => table.classList.remove("whole"));
  });
})();
