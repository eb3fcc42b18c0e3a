// What the reader has chosen: values of the parameters, which of them are held, the shown place of
// each field. Whoever shows something of it is told of changes.

export function stateOf(data) {
  const listeners = [];
  const state = {
    values: data.parameters.map((one) => one.start),
    held: data.parameters.map(() => false),
    places: data.outputs.map(({ places }) =>
      (places ? flat(places.shape.map((n) => Math.floor(n / 2)), places.shape) : 0)),
  };

  function change(part) {
    Object.assign(state, part);
    listeners.forEach((listen) => listen(Object.keys(part)));
  }

  return {
    get: () => state,
    change,
    set: (j, value) => change({ values: state.values.map((old, k) => (k === j ? value : old)) }),
    hold: (j, held) => change({ held: state.held.map((old, k) => (k === j ? held : old)) }),
    place: (k, place) => change({ places: state.places.map((old, i) => (i === k ? place : old)) }),
    reset: () => change({ values: data.parameters.map((one) => one.start) }),
    listen: (listener) => listeners.push(listener),
  };
}

// Number of a place in C order, and back.
export function flat(index, shape) {
  return index.reduce((sum, k, d) => sum * shape[d] + k, 0);
}

export function unflat(place, shape) {
  const index = [];
  for (let [d, rest] = [shape.length - 1, place]; d >= 0; d--) {
    index[d] = rest % shape[d];
    rest = Math.floor(rest / shape[d]);
  }
  return index;
}
