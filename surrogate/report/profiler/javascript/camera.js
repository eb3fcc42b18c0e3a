// Who looks at the scene: azimuth from x towards y and elevation, degrees; parallel rays.

const RAD = Math.PI / 180;

// Unit vectors [right, up, towards the viewer] of a view.
export function axesOf({ azimuth, elevation }) {
  const [ca, sa] = [Math.cos(azimuth * RAD), Math.sin(azimuth * RAD)];
  const [ce, se] = [Math.cos(elevation * RAD), Math.sin(elevation * RAD)];
  return [[-sa, ca, 0], [-se * ca, -se * sa, ce], [ce * ca, ce * sa, se]];
}

// across, down in pixels and nearness of a place; extent: middle, and reach across and up from it.
export function projection(view, { middle, across, up }, width, height) {
  const axes = axesOf(view);
  const [s, c] = [Math.abs(Math.sin(view.elevation * RAD)), Math.abs(Math.cos(view.elevation * RAD))];
  const scale = view.zoom * 0.94 * Math.min(width / (2 * across), height / (2 * (up * c + across * s)));
  const place = (x, y, z) => {
    const [dx, dy, dz] = [x - middle[0], y - middle[1], z - middle[2]];
    const [r, u, n] = axes.map(([a, b, d]) => a * dx + b * dy + d * dz);
    return [width / 2 + scale * r, height / 2 - scale * u, n];
  };
  return { axes, scale, place };
}
