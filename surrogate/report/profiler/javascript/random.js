// Pseudo-random numbers from a seed: xoshiro128++ (Blackman and Vigna 2021).

export function generator(seed) {
  // The state comes from the seed by splitmix32, so that no seed is a bad one.
  let mixed = seed >>> 0;
  const state = Uint32Array.from({ length: 4 }, () => {
    mixed = (mixed + 0x9e3779b9) >>> 0;
    let z = mixed;
    z = Math.imul(z ^ (z >>> 16), 0x21f0aaad);
    z = Math.imul(z ^ (z >>> 15), 0x735a2d97);
    return z ^ (z >>> 15);
  });
  // Fills a column with uniform numbers in (0, 1).
  function uniforms(column) {
    let [a, b, c, d] = state;
    for (let i = 0; i < column.length; i++) {
      const sum = (a + d) | 0;
      column[i] = ((((sum << 7) | (sum >>> 25)) + a >>> 0) + 0.5) / 4294967296;
      const shifted = b << 9;
      c ^= a;
      d ^= b;
      b ^= c;
      a ^= d;
      c ^= shifted;
      d = (d << 11) | (d >>> 21);
    }
    state.set([a, b, c, d]);
    return column;
  }

  const one = new Float64Array(1);
  const uniform = () => uniforms(one)[0];

  // Fills a column with standard normal numbers (Box and Muller 1958).
  function normals(column) {
    const u = uniforms(new Float64Array(column.length + column.length % 2));
    for (let i = 0; i < column.length; i += 2) {
      const radius = Math.sqrt(-2 * Math.log(u[i]));
      const angle = 2 * Math.PI * u[i + 1];
      column[i] = radius * Math.cos(angle);
      if (i + 1 < column.length) column[i + 1] = radius * Math.sin(angle);
    }
    return column;
  }

  return { uniform, uniforms, normals };
}
