// Desirability of several outputs at once: Derringer and Suich 1980, Journal of Quality
// Technology 12, 214. A goal is {kind, low, target, high, weight, soft}.
//   maximise  0 at `low`, 1 from `high` on       minimise  1 up to `low`, 0 at `high`
//   target    0 at `low` and `high`, 1 at `target`
//   limits    1 from `low` to `high`, 0 a width `soft` outside; a limit may be infinite

// Below 0 and above 1 where `desirability` is cut off: says which way leads back.
function uncut(goal, y) {
  const { kind, low, target, high, soft } = goal;
  switch (kind) {
    case "maximise": return (y - low) / (high - low);
    case "minimise": return (high - y) / (high - low);
    case "target": return y <= target ? (y - low) / (target - low) : (high - y) / (high - target);
    case "limits": return 1 - Math.max(low - y, y - high, 0) / soft;
    default: throw new Error(`goal ${kind} is unknown`);
  }
}

export function desirability(goal, y) {
  return Math.min(Math.max(uncut(goal, y), 0), 1);
}

// Weighted geometric mean of the desirabilities (Derringer 1994); where one of them is 0, less
// than 0 by how far all are from their goals.
export function merit(goals, values) {
  let total = 0;
  let logs = 0;
  let missed = 0;
  goals.forEach((goal, k) => {
    const own = uncut(goal, values[k]);
    total += goal.weight;
    logs += goal.weight * Math.log(Math.min(Math.max(own, 0), 1));
    missed += goal.weight * Math.min(own, 0);
  });
  return missed < 0 || logs === -Infinity ? missed / total : Math.exp(logs / total);
}

// Probability that the output has a desirability above 0 (for limits: lies inside of them);
// below(limit) is the probability of a value under a limit.
export function probability({ kind, low, high }, below) {
  const upper = kind === "maximise" || high === Infinity ? 1 : below(high);
  const lower = kind === "minimise" || low === -Infinity ? 0 : below(low);
  return upper - lower;
}
