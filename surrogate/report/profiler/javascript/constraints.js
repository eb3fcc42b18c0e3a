// Constraints of a study: trees such as ["+", ["input", 0, slope, offset], 80], compared.

const OPERATIONS = {
  "+": (a, b) => a + b,
  "-": (a, b) => a - b,
  "*": (a, b) => a * b,
  "/": (a, b) => a / b,
  "^": (a, b) => a ** b,
  negative: (a) => -a,
  sqrt: Math.sqrt,
  abs: Math.abs,
  min: Math.min,
  max: Math.max,
  log: Math.log,
  exp: Math.exp,
};
const EQUAL = 1e-9;

// Value in base units, of physical values in the order of the parameters.
function valueOf(tree, physical) {
  if (typeof tree === "number") return tree;
  const [kind, ...rest] = tree;
  if (kind === "input") return physical[rest[0]] * rest[1] + rest[2];
  return OPERATIONS[kind](...rest.map((part) => valueOf(part, physical)));
}

function pairs({ sides, compared }, physical) {
  const values = sides.map((side) => valueOf(side, physical));
  return compared.map((sign, k) => [sign, values[k], values[k + 1]]);
}

export function holds(constraint, physical) {
  return pairs(constraint, physical).every(([sign, left, right]) => {
    switch (sign) {
      case "<": return left < right;
      case ">": return left > right;
      case "<=": return left <= right;
      case ">=": return left >= right;
      default: return Math.abs(left - right) <= EQUAL * Math.max(Math.abs(left), Math.abs(right));
    }
  });
}

// How much it is broken by, as a share of its sides; 0 where it holds.
export function violation(constraint, physical) {
  return pairs(constraint, physical).reduce((most, [sign, left, right]) => {
    const scale = Math.max(Math.abs(left), Math.abs(right), 1e-300);
    const away = (sign.startsWith("<") ? left - right : right - left) / scale;
    const own = sign === "=" ? Math.max(Math.abs(left - right) / scale - EQUAL, 0) : away;
    return Math.max(most, Number.isNaN(own) ? Infinity : own);
  }, 0);
}
