// Sums of products of columns, some points at a time so that columns stay in the cache.

export const BLOCK = 1024;

// Calls part(block of points, size, start) for points given as one array a coordinate.
export function inBlocks(points, size, part) {
  for (let start = 0; start < size; start += BLOCK) {
    const end = Math.min(start + BLOCK, size);
    part(points.map((one) => one.subarray(start, end)), end - start, start);
  }
}

// total += coefficient * product of the factors, each (size,).
export function addProduct(total, coefficient, factors, size) {
  const [a, b, c] = factors;
  switch (factors.length) {
    case 0: for (let i = 0; i < size; i++) total[i] += coefficient; break;
    case 1: for (let i = 0; i < size; i++) total[i] += coefficient * a[i]; break;
    case 2: for (let i = 0; i < size; i++) total[i] += coefficient * a[i] * b[i]; break;
    case 3: for (let i = 0; i < size; i++) total[i] += coefficient * a[i] * b[i] * c[i]; break;
    default: {
      const product = a.slice(0, size);
      for (let k = 1; k < factors.length; k++) {
        const factor = factors[k];
        for (let i = 0; i < size; i++) product[i] *= factor[i];
      }
      addProduct(total, coefficient, [product], size);
    }
  }
}
