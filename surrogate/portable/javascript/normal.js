// The normal law.

const ERF_A = [1.85777706184603153e-1, 3.16112374387056560, 1.13864154151050156e2,
  3.77485237685302021e2, 3.20937758913846947e3];
const ERF_B = [1, 2.36012909523441209e1, 2.44024637934444173e2, 1.28261652607737228e3,
  2.84423683343917062e3];
const ERF_C = [2.15311535474403846e-8, 5.64188496988670089e-1, 8.88314979438837594,
  6.61191906371416295e1, 2.98635138197400131e2, 8.81952221241769090e2, 1.71204761263407058e3,
  2.05107837782607147e3, 1.23033935479799725e3];
const ERF_D = [1, 1.57449261107098347e1, 1.17693950891312499e2, 5.37181101862009858e2,
  1.62138957456669019e3, 3.29079923573345963e3, 4.36261909014324716e3, 3.43936767414372164e3,
  1.23033935480374942e3];
const ERF_P = [1.63153871373020978e-2, 3.05326634961232344e-1, 3.60344899949804439e-1,
  1.25781726111229246e-1, 1.60837851487422766e-2, 6.58749161529837803e-4];
const ERF_Q = [1, 2.56852019228982242, 1.87295284992346725, 5.27905102951428412e-1,
  6.05183413124413191e-2, 2.33520497626869185e-3];

// Highest power first (Horner).
function horner(coefficients, x) {
  let sum = 0;
  for (let k = 0; k < coefficients.length; k++) sum = sum * x + coefficients[k];
  return sum;
}

// exp(-x^2), the square split so that its rounding does not grow.
function gauss(x) {
  const near = Math.trunc(x * 16) / 16;
  return Math.exp(-near * near) * Math.exp(-(x - near) * (x + near));
}

// erfc(x) by rational approximations (Cody 1969, Mathematics of Computation 23, 631).
export function erfc(x) {
  const size = Math.abs(x);
  if (size <= 0.46875) return 1 - erf(x);
  let tail;
  if (size <= 4) tail = gauss(size) * horner(ERF_C, size) / horner(ERF_D, size);
  else {
    const square = 1 / (size * size);
    const rest = square * horner(ERF_P, square) / horner(ERF_Q, square);
    tail = gauss(size) * (0.5641895835477562869 - rest) / size;
  }
  return x < 0 ? 2 - tail : tail;
}

export function erf(x) {
  if (Math.abs(x) > 0.46875) return x < 0 ? erfc(-x) - 1 : 1 - erfc(x);
  return x * horner(ERF_A, x * x) / horner(ERF_B, x * x);
}

// Probability of a smaller value.
export function normalCdf(z) {
  return 0.5 * erfc(-z * Math.SQRT1_2);
}

const CENTRE_A = [2.5090809287301226727e3, 3.3430575583588128105e4, 6.7265770927008700853e4,
  4.5921953931549871457e4, 1.3731693765509461125e4, 1.9715909503065514427e3,
  1.3314166789178437745e2, 3.3871328727963666080];
const CENTRE_B = [5.2264952788528545610e3, 2.8729085735721942674e4, 3.9307895800092710610e4,
  2.1213794301586595867e4, 5.3941960214247511077e3, 6.8718700749205790830e2,
  4.2313330701600911252e1, 1];
const MIDDLE_C = [7.74545014278341407640e-4, 2.27238449892691845833e-2, 2.41780725177450611770e-1,
  1.27045825245236838258, 3.64784832476320460504, 5.76949722146069140550, 4.63033784615654529590,
  1.42343711074968357734];
const MIDDLE_D = [1.05075007164441684324e-9, 5.47593808499534494600e-4, 1.51986665636164571966e-2,
  1.48103976427480074590e-1, 6.89767334985100004550e-1, 1.67638483018380384940,
  2.05319162663775882187, 1];
const TAIL_E = [2.01033439929228813265e-7, 2.71155556874348757815e-5, 1.24266094738807843860e-3,
  2.65321895265761230930e-2, 2.96560571828504891230e-1, 1.78482653991729133580,
  5.46378491116411436990, 6.65790464350110377720];
const TAIL_F = [2.04426310338993978564e-15, 1.42151175831644588870e-7, 1.84631831751005468180e-5,
  7.86869131145613259100e-4, 1.48753612908506148525e-2, 1.36929880922735805310e-1,
  5.99832206555887937690e-1, 1];

// The value below which the probability is u (Wichura 1988, Applied Statistics 37, AS 241).
export function normalQuantile(u) {
  const q = u - 0.5;
  if (Math.abs(q) <= 0.425) {
    const r = 0.180625 - q * q;
    return q * horner(CENTRE_A, r) / horner(CENTRE_B, r);
  }
  const r = Math.sqrt(-Math.log(q < 0 ? u : 1 - u));
  const z = r <= 5 ? horner(MIDDLE_C, r - 1.6) / horner(MIDDLE_D, r - 1.6)
    : horner(TAIL_E, r - 5) / horner(TAIL_F, r - 5);
  return q < 0 ? -z : z;
}
