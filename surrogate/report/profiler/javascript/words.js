// Numbers as people read them: a true minus sign, as many digits as mean something.

const MINUS = "\u2212";

export function fixed(value, decimals) {
  if (!Number.isFinite(value)) return "\u2013";
  const text = value.toFixed(Math.min(Math.max(decimals, 0), 12));
  return (/[1-9]/.test(text) ? text : text.replace("-", "")).replace("-", MINUS);
}

export function figure(value, digits = 4) {
  if (!Number.isFinite(value)) return "\u2013";
  if (value === 0) return "0";
  const size = Math.floor(Math.log10(Math.abs(value)));
  if (size < -4 || size > 6) return value.toExponential(digits - 1).replace("-", MINUS);
  return fixed(value, digits - 1 - size);
}

// Decimals with which a width shows two digits.
export function decimalsOf(width) {
  return width > 0 && Number.isFinite(width) ? Math.min(Math.max(1 - Math.floor(Math.log10(width)), 0), 9) : 4;
}

// A number as it would be typed: all its digits, but not those of rounding.
export function typed(value) {
  if (typeof value !== "number") return value;
  return String(Number(value.toPrecision(12))).replace("-", MINUS);
}

export function typedNumber(text) {
  const cleaned = text.trim().replace(MINUS, "-").replace(/^(-?\d*),(\d+)$/, "$1.$2");
  return cleaned === "" ? NaN : Number(cleaned);
}

export function withUnit(words, unit) {
  return unit ? `${words}\u00a0${unit}` : words;
}

// About `count` round numbers between two ends, with the decimals that they need.
export function ticks(low, high, count) {
  const rough = (high - low) / count;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].find((factor) => factor * power >= rough * 0.999) * power;
  const decimals = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  const found = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k++) {
    found.push([k * step, fixed(k * step, decimals)]);
  }
  return found;
}
