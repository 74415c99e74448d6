#pragma once

#include <cmath>

#include "sheets.h"

namespace nuno {

/// Two uneven triangles on an edge along x, the second turned up by `angle` against the first.
inline Mesh hinged(double angle) {
  Mesh mesh;
  mesh.vertices = Points{{0.0, 0.5, 0.2, 0.35},
                         {0.0, 0.0, 0.0, -0.4 * std::sin(angle)},
                         {0.0, 0.0, -0.3, 0.4 * std::cos(angle)}};
  mesh.faces = {{0, 1, 2}, {1, 0, 3}};
  return mesh;
}

}  // namespace nuno
