// Answers of the profiler's engine: {data, questions: [{kind, ...}]} on stdin. Infinite limits
// are written as null.
import { readFileSync } from "node:fs";
import { engine, opened } from "../../surrogate/report/profiler/javascript/engine.js";

const { data, questions } = JSON.parse(readFileSync(0, "utf8"));
const working = engine(opened(data));
const open = ([low, high]) => [low ?? -Infinity, high ?? Infinity];
const answers = [];
for (const { kind, ...question } of questions) {
  if (question.limits) question.limits = question.limits.map(open);
  answers.push(await working[kind](question, async () => {}));
}
process.stdout.write(JSON.stringify(answers));
