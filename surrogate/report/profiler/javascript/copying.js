// The point as words that the command line and study files understand.
import { el } from "./elements.js";

const PLAIN = /^[A-Za-z0-9_.+-]+$/;

function inShell(word) {
  return PLAIN.test(word) ? word : `'${word.replaceAll("'", "'\\''")}'`;
}

// Commands that print the shown numbers: one, or one for each surrogate where not all are best.
export function commands({ study, parameters, outputs }, values) {
  const words = parameters.map(({ name }, j) => inShell(`${name}=${values[j]}`)).join(" ");
  const all = outputs.every((one) => one.surrogate === one.best);
  const names = all ? [null] : [...new Set(outputs.map((one) => one.surrogate))];
  return names.map((name) => `surrogate predict ${inShell(`${study}.yaml`)}`
    + `${name === null ? "" : ` --surrogate ${inShell(name)}`} ${words}`).join("\n");
}

// The point as constants of a study file; in the units of its solver.
export function constants({ parameters }, values) {
  const lines = parameters.map(({ name, unit }, j) => {
    const value = typeof values[j] === "number" ? values[j] : JSON.stringify(values[j]);
    return `  ${name}: ${value}${unit ? `   # ${unit}` : ""}`;
  });
  return ["constants:", ...lines, ""].join("\n");
}

// The goals as `solve:` of a study file; limits are what the others are subject to.
export function solve({ parameters, outputs }, values, held, goals) {
  const words = { maximise: ({ low, high }) => [low, high], minimise: ({ low, high }) => [low, high],
    target: ({ low, target, high }) => [low, target, high] };
  const [worth, limits] = [[], []];
  goals.forEach((goal, k) => {
    if (!goal) return;
    const { name, unit } = outputs[k];
    const limit = (sign, value) => limits.push(`"${name} ${sign} ${value}${unit ? ` ${unit}` : ""}"`);
    if (goal.kind === "limits") {
      if (goal.low > -Infinity) limit(">=", goal.low);
      if (goal.high < Infinity) limit("<=", goal.high);
      return;
    }
    const importance = goal.weight === 1 ? "" : `, importance: ${goal.weight}`;
    worth.push(`      ${name}: {${goal.kind}: [${words[goal.kind](goal).join(", ")}]${importance}}`);
  });
  const fixed = parameters.flatMap(({ name }, j) => (held[j]
    ? [`${name}: ${typeof values[j] === "number" ? values[j] : JSON.stringify(values[j])}`] : []));
  return ["solve:", "  explored:", ...(worth.length ? ["    desirability:", ...worth] : []),
    ...(limits.length ? [`    subject_to: [${limits.join(", ")}]`] : []),
    ...(fixed.length ? [`    fix: {${fixed.join(", ")}}`] : []), ""].join("\n");
}

// Buttons that copy, and show what they have copied; asked() gives the goals.
export function copying(data, state, asked) {
  const shown = el("textarea", { readonly: true, rows: 2, hidden: true, "aria-label": "Copied" });
  const said = el("span", { class: "said", role: "status" });

  async function copy(text) {
    shown.hidden = false;
    shown.value = text;
    shown.rows = Math.min(text.trimEnd().split("\n").length, 8);
    try {
      await navigator.clipboard.writeText(text);
      said.textContent = "Copied.";
    } catch {
      shown.select();
      said.textContent = document.execCommand("copy") ? "Copied." : "Select and copy:";
    }
  }
  const button = (words, text) => el("button", { type: "button",
    click: () => copy(text(data, state.get().values)) }, words);
  const yaml = (_, values) => {
    const goals = asked().map((goal) => (typeof goal === "string" ? null : goal));
    return constants(data, values)
      + (goals.some(Boolean) ? solve(data, values, state.get().held, goals) : "");
  };
  return { buttons: [button("Copy as YAML", yaml), button("Copy as command", commands)],
    said, shown };
}
