// Values of the special functions: {z, u, t, freedoms} on stdin.
import { readFileSync } from "node:fs";
import { erf, normalCdf, normalQuantile } from "../../surrogate/portable/javascript/normal.js";
import { studentCdf } from "../../surrogate/portable/javascript/student.js";

const { z, u, t, freedoms } = JSON.parse(readFileSync(0, "utf8"));
process.stdout.write(JSON.stringify({
  erf: z.map(erf),
  cdf: z.map(normalCdf),
  quantile: u.map(normalQuantile),
  student: freedoms.map((freedom) => t.map((value) => studentCdf(value, freedom))),
}));
