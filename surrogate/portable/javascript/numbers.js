// Arrays of numbers as text: {"float64": base64, "shape": [..]} and {"shared": k}.
// A matrix becomes an array of rows, each a Float64Array; what is shared is decoded once.

function decoded(text, shape) {
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  return rows(new Float64Array(bytes.buffer), shape);
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
  return Object.fromEntries(Object.entries(part).map(([key, one]) => [key, unpacked(one, shared)]));
}
