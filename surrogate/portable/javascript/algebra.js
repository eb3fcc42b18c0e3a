// Triangular factors; matrices are flat, row after row.

// Lower factor L of a positive definite matrix (n, n) = L L', of which the lower part is read.
export function cholesky(matrix, n) {
  const lower = new Float64Array(n * n);
  for (let i = 0; i < n; i++) {
    const row = lower.subarray(i * n, i * n + i + 1);
    for (let j = 0; j <= i; j++) {
      const other = lower.subarray(j * n, j * n + j);
      let sum = matrix[i * n + j];
      for (let k = 0; k < j; k++) sum -= row[k] * other[k];
      row[j] = i === j ? Math.sqrt(sum) : sum / lower[j * n + j];
    }
  }
  return lower;
}

// Overwrites b (n,) with L^-1 b.
export function forward(lower, b, n) {
  for (let i = 0; i < n; i++) {
    const row = i * n;
    // Four sums that do not wait for each other.
    let [sum, second, third, fourth] = [b[i], 0, 0, 0];
    let k = 0;
    for (; k + 3 < i; k += 4) {
      sum -= lower[row + k] * b[k];
      second -= lower[row + k + 1] * b[k + 1];
      third -= lower[row + k + 2] * b[k + 2];
      fourth -= lower[row + k + 3] * b[k + 3];
    }
    for (; k < i; k++) sum -= lower[row + k] * b[k];
    b[i] = (sum + second + third + fourth) / lower[row + i];
  }
  return b;
}

// Overwrites b (n,) with L'^-1 b.
export function backward(lower, b, n) {
  for (let i = n - 1; i >= 0; i--) {
    b[i] /= lower[i * n + i];
    for (let k = 0; k < i; k++) b[k] -= lower[i * n + k] * b[i];
  }
  return b;
}

// R' (r, r) of X = Q R by Householder reflections; columns of X are arrays (n,), overwritten.
export function lowerOfColumns(columns) {
  const r = columns.length;
  const lower = new Float64Array(r * r);
  columns.forEach((pivot, k) => {
    let square = 0;
    for (let i = k; i < pivot.length; i++) square += pivot[i] * pivot[i];
    const length = pivot[k] > 0 ? -Math.sqrt(square) : Math.sqrt(square);
    const head = pivot[k] - length;
    const scale = length * head;
    for (let j = k; j < r; j++) {
      const column = columns[j];
      if (j > k && scale !== 0) {
        let along = head * column[k];
        for (let i = k + 1; i < column.length; i++) along += pivot[i] * column[i];
        const share = along / scale;
        column[k] += share * head;
        for (let i = k + 1; i < column.length; i++) column[i] += share * pivot[i];
      }
      lower[j * r + k] = j === k ? length : column[k];
    }
  });
  return lower;
}
