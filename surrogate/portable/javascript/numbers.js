// Arrays of numbers as text: {"float64": base64, "shape": [..]} and {"shared": k}.
// A matrix becomes an array of rows, each a Float64Array; what is shared is decoded once.
// {"steps": ["low step bytes base64", ...]} is an array of rows, low + step * whole number: stored
// are differences of these, all low bytes and then all high ones.

function decoded(text, shape) {
  return rows(new Float64Array(bytesOf(text).buffer), shape);
}

function bytesOf(text) {
  return Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
}

function dequantised(row) {
  const [low, step, size, text] = row.split(" ");
  const bytes = bytesOf(text);
  const count = bytes.length / Number(size);
  const mask = 256 ** Number(size) - 1;
  let whole = 0;
  return Float64Array.from({ length: count }, (_, i) => {
    whole = (whole + bytes[i] + (size === "2" ? 256 * bytes[count + i] : 0)) & mask;
    return Number(low) + Number(step) * whole;
  });
}

function rows(flat, shape) {
  if (shape.length === 1) return flat;
  const size = shape.slice(1).reduce((a, b) => a * b, 1);
  return Array.from({ length: shape[0] }, (_, k) =>
    rows(flat.subarray(k * size, (k + 1) * size), shape.slice(1)));
}

// The document with numbers in place of their text.
export function unpacked(part, shared = []) {
  if (Array.isArray(part)) return part.map((one) => unpacked(one, shared));
  if (part === null || typeof part !== "object" || ArrayBuffer.isView(part)) return part;
  if ("shared" in part) return shared[part.shared];
  if ("float64" in part) return decoded(part.float64, part.shape);
  if ("steps" in part) return part.steps.map(dequantised);
  return Object.fromEntries(Object.entries(part).map(([key, one]) => [key, unpacked(one, shared)]));
}
