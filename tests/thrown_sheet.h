#pragma once

#include <nuno/problem.h>

#include <cmath>

namespace nuno {

/// A flat square of this side about the origin in the plane y = 0: columns × columns vertices, and
/// quads but for those cut into triangles, every third.
inline SheetScene square(Index columns, double side, bool all_quads = true) {
  SheetScene scene;
  scene.arrival_time = 1;
  scene.initial = Points::Zero(3, columns * columns);
  const double spacing = side / static_cast<double>(columns - 1);
  for (Index i = 0; i < columns * columns; ++i) {
    scene.initial(0, i) = spacing * static_cast<double>(i % columns) - side / 2;
    scene.initial(2, i) = spacing * static_cast<double>(i / columns) - side / 2;
  }
  for (Index j = 0; j + 1 < columns; ++j) {
    for (Index i = 0; i + 1 < columns; ++i) {
      const Index a = j * columns + i, b = a + columns, c = b + 1, d = a + 1;
      if (all_quads || (i + j) % 3 != 0) {
        scene.faces.push_back({a, b, c, d});
      } else {
        scene.faces.push_back({a, b, c});
        scene.faces.push_back({a, c, d});
      }
    }
  }
  scene.target = scene.initial;
  return scene;
}

/// A square of cloth thrown into a part of a tube, askew, under damped control: well-conditioned.
inline SheetScene throw_scene(bool all_quads = true) {
  SheetScene scene = square(9, 0.8, all_quads);
  scene.reference = Reference::morph;
  scene.damping_ratio = 0.7;
  for (Index i = 0; i < scene.target.cols(); ++i) {
    const Eigen::Vector3d x = scene.initial.col(i);
    const double turn = (x.x() + 0.4 * x.z()) / 0.3;
    scene.target.col(i) << 2 + 0.3 * std::sin(turn), 1 + 0.3 * (1 - std::cos(turn)),
        0.5 + x.z() - 0.4 * x.x();
  }
  scene.target_length = TargetLength::fit;
  return scene;
}

/// m/t₀² [N/m].
inline double gain_scale(const Problem& problem) {
  return problem.cloth().particle_mass / (problem.arrival_time * problem.arrival_time);
}

/// The largest distance between two points of one number.
inline double farthest(const Points& a, const Points& b) {
  return (a - b).colwise().norm().maxCoeff();
}

inline SheetMaterial without_losses() {
  return {.air_drag = 0, .stretch_damping = 0, .shear_damping = 0};
}

}  // namespace nuno
