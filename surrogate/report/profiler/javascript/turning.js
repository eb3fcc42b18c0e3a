// Turning and zooming of a view by pointer, two fingers, wheel and keys.

const clamped = (value, low, high) => Math.min(Math.max(value, low), high);

// Changes `view` in place and calls moved(); read(event) is told of pointers that only point.
export function turning(canvas, view, home, moved, read) {
  const turn = (around, up) => {
    view.azimuth += around;
    view.elevation = clamped(view.elevation + up, -90, 90);
    moved();
  };
  const zoom = (factor) => {
    view.zoom = clamped(view.zoom * factor, 0.5, 8);
    moved();
  };
  const held = new Map(); // where each finger, or the mouse, was last
  const apart = () => {
    const [[a, b], [c, d]] = held.values();
    return Math.max(Math.hypot(a - c, b - d), 1);
  };
  canvas.addEventListener("pointerdown", (event) => {
    held.set(event.pointerId, [event.clientX, event.clientY]);
    canvas.setPointerCapture(event.pointerId);
    read(event);
  });
  canvas.addEventListener("pointermove", (event) => {
    const before = held.get(event.pointerId);
    if (!before) {
      read(event);
      return;
    }
    const now = [event.clientX, event.clientY];
    if (held.size === 2) {
      const span = apart();
      held.set(event.pointerId, now);
      zoom(apart() / span);
      return;
    }
    held.set(event.pointerId, now);
    turn(-0.5 * (now[0] - before[0]), event.pointerType === "touch" ? 0 : 0.4 * (now[1] - before[1]));
  });
  for (const end of ["pointerup", "pointercancel"]) {
    canvas.addEventListener(end, (event) => held.delete(event.pointerId));
  }
  canvas.addEventListener("wheel", (event) => {
    if (document.activeElement !== canvas && !event.ctrlKey) return;
    event.preventDefault();
    zoom(Math.exp(-event.deltaY / 500));
  }, { passive: false });
  const keys = { ArrowLeft: () => turn(8, 0), ArrowRight: () => turn(-8, 0),
    ArrowUp: () => turn(0, -8), ArrowDown: () => turn(0, 8), "+": () => zoom(1.15),
    "=": () => zoom(1.15), "-": () => zoom(1 / 1.15), 0: () => {
      Object.assign(view, home);
      moved();
    } };
  canvas.addEventListener("keydown", (event) => {
    if (!keys[event.key] || event.metaKey || event.ctrlKey || event.altKey) return;
    event.preventDefault();
    keys[event.key]();
  });
}
