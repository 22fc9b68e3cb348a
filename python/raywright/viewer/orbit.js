// The camera's orbit around its target: orbit.py for local drawing.

export const START = { azimuth: 0, elevation: 0, zoom: 1, right: 0, up: 0 };
export const ZOOM = [1 / 256, 256];

export const clamp = (value, [least, most]) => Math.min(Math.max(value, least), most);
export const plus = (a, b) => a.map((value, i) => value + b[i]);
export const minus = (a, b) => a.map((value, i) => value - b[i]);
export const times = (a, factor) => a.map((value) => value * factor);
export const dot = (a, b) => a.reduce((sum, value, i) => sum + value * b[i], 0);
export const cross = ([a, b, c], [x, y, z]) => [b * z - c * y, c * x - a * z, a * y - b * x];
const applied = (matrix, vector) => matrix.map((row) => dot(row, vector));

// The rotation about a unit axis, by rows (Rodrigues 1840).
function rotation([x, y, z], degrees) {
  const angle = (degrees * Math.PI) / 180;
  const [sine, versine] = [Math.sin(angle), 1 - Math.cos(angle)];
  return [
    [1 - versine * (y * y + z * z), versine * x * y - sine * z, versine * x * z + sine * y],
    [versine * x * y + sine * z, 1 - versine * (x * x + z * z), versine * y * z - sine * x],
    [versine * x * z - sine * y, versine * y * z + sine * x, 1 - versine * (x * x + y * y)],
  ];
}

// Rays over the picture of a view: the ray at its upper left, and the steps across and down.
export function spread(orbit, view) {
  const raised = clamp(view.elevation, orbit.elevations);
  const around = rotation(orbit.up, view.azimuth);
  const over = rotation(orbit.right, -raised);
  const turned = (vector) => applied(around, applied(over, vector));
  const moved = times(
    plus(times(orbit.right, view.right), times(orbit.pictureUp, view.up)),
    -orbit.height,
  );
  const pivot = plus(orbit.pivot, turned(moved));
  const position = plus(pivot, times(turned(minus(orbit.position, orbit.pivot)), 1 / view.zoom));
  // Parallel rays: the picture shrinks by the zoom.
  const [corner, ...sides] = orbit.origins;
  const nearer = (vector) => times(turned(vector), 1 / view.zoom);
  return {
    origins: [plus(position, nearer(minus(corner, orbit.position))), ...sides.map(nearer)],
    ways: orbit.ways.map(turned),
  };
}

// The inverse of the matrix with these rows, by columns: dot products with them give a vector's components.
export function inverse([a, b, c]) {
  const [p, q, r] = [cross(b, c), cross(c, a), cross(a, b)];
  const determinant = dot(a, p);
  return [p, q, r].map((column) => times(column, 1 / determinant));
}
