// Answers questions {id, kind, ...} one after the other; of a kind only the newest counts.
import { engine, opened } from "./engine.js";

// A turn of the event loop, in which messages come in.
function turn() {
  return new Promise((resume) => {
    const channel = new MessageChannel();
    channel.port1.onmessage = () => {
      channel.port1.close();
      resume();
    };
    channel.port2.postMessage(null);
  });
}

const STALE = Symbol("a newer question of this kind has come");

// serving(post)(question): answers are posted as {id, answer}, {id, progress} or {id, failed}.
export function serving(post) {
  const newest = {};
  let working = null;

  return async function receive(question) {
    const { id, kind } = question;
    newest[kind] = id;
    await turn();
    const pause = async (progress) => {
      post({ id, progress });
      await turn();
      if (newest[kind] !== id) throw STALE;
    };
    try {
      if (kind === "open") working = engine(opened(question.data));
      else if (newest[kind] === id) post({ id, answer: await working[kind](question, pause) });
    } catch (error) {
      if (error !== STALE) post({ id, failed: String(error.message || error) });
    }
  };
}
