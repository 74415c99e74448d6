// Meshes of one's own.

// A square mesh of `side`² points in the plane z = 0 … 1, where `place(u, v)` puts them, as OBJ.
export function square_mesh(side, place) {
  const points = Array.from({ length: side * side }, (_, i) => place((i % side) / (side - 1), Math.floor(i / side) / (side - 1)));
  const corners = Array.from({ length: (side - 1) ** 2 }, (_, f) => side * Math.floor(f / (side - 1)) + (f % (side - 1)));
  return { points, faces: corners.map((a) => [a, a + 1, a + side + 1, a + side]) };
}
export const obj_text = ({ points, faces }) =>
  points.map((point) => `v ${point.join(' ')}\n`).join('') + faces.map((face) => `f ${face.map((i) => i + 1).join(' ')}\n`).join('');
