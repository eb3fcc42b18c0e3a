// Answers of portable surrogates: {shared, cases: [{document, place, points}]} on stdin.
import { readFileSync } from "node:fs";
import { unpacked } from "../../surrogate/portable/javascript/numbers.js";
import { surrogate } from "../../surrogate/portable/javascript/surrogate.js";

const given = JSON.parse(readFileSync(0, "utf8"));
const shared = given.shared.map((one) => unpacked(one));
const answers = given.cases.map(({ document, place, points }) => {
  const columns = points[0].map((_, j) => Float64Array.from(points, (row) => row[j]));
  const found = surrogate(unpacked(document, shared), place).predict(columns, points.length);
  return Object.fromEntries(Object.entries(found).map(([key, values]) => [key, Array.from(values)]));
});
process.stdout.write(JSON.stringify(answers));
