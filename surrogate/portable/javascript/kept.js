// What is worked out once of a set of runs, whatever surrogates use it.

const known = new WeakMap();

// What `make` gives for these runs and this key, made when it is first asked for.
export function keptFor(runs, key, make) {
  if (!known.has(runs)) known.set(runs, new Map());
  const own = known.get(runs);
  if (!own.has(key)) own.set(key, make());
  return own.get(key);
}
