// Questions to the engine: in a worker where the browser allows one, else between the turns of
// the page's own event loop.
import { serving } from "./serving.js";

function inWorker(script, reply) {
  const address = URL.createObjectURL(new Blob([script], { type: "text/javascript" }));
  const worker = new Worker(address);
  worker.onmessage = ({ data }) => reply(data);
  return { send: (message) => worker.postMessage(message), worker };
}

// ask(kind, question, progress) is a promise of the answer; one that a newer question of the
// same kind has overtaken is never kept.
export function asking(script, data) {
  const open = new Map();
  let count = 0;

  function reply({ id, answer, progress, failed }) {
    const waiting = open.get(id);
    if (!waiting) return;
    if (progress !== undefined) {
      waiting.progress?.(progress);
      return;
    }
    open.delete(id);
    if (failed === undefined) waiting.resolve(answer);
    else waiting.reject(new Error(failed));
  }

  let send;
  const here = () => {
    const receive = serving(reply);
    receive({ kind: "open", data });
    return receive;
  };
  try {
    const made = inWorker(script, reply);
    send = made.send;
    made.worker.onerror = (event) => {
      event.preventDefault();
      send = here();
      for (const [id, { kind, question }] of open) send({ ...question, id, kind });
    };
    send({ kind: "open", data });
  } catch {
    send = here();
  }

  return function ask(kind, question, progress) {
    const id = ++count;
    for (const [other, waiting] of open) if (waiting.kind === kind) open.delete(other);
    return new Promise((resolve, reject) => {
      open.set(id, { kind, question, resolve, reject, progress });
      send({ ...question, id, kind });
    });
  };
}
