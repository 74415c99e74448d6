#include "problems.h"

#include <cmath>
#include <numbers>

#include "scene_library.h"

namespace nuno::bench {

ChainScene straight_to_s(Index particles) {
  ChainScene scene = scene_library::straight_to_s();
  scene.particles = particles;
  return scene;
}

Problem release(Index particles) {
  ChainScene scene = straight_to_s(particles);
  scene.name = "release";
  scene.cloth.air_drag = 0;
  scene.initial = scene.target;
  scene.target.row(1).array() -= 0.5 * scene.gravity * scene.arrival_time * scene.arrival_time;
  return make_problem(scene);
}

namespace {

/// A square metre of cloth, flat, and bent to an S by turns of its columns of cells.
SheetScene square_to_s(Index columns) {
  SheetScene scene;
  scene.name = "square-to-s";
  scene.arrival_time = 1;
  scene.initial.resize(3, columns * columns);
  scene.target.resize(3, columns * columns);
  const double spacing = 1 / static_cast<double>(columns - 1);
  Eigen::Vector2d at(2.5, 1.4);
  for (Index i = 0; i < columns; ++i) {
    for (Index j = 0; j < columns; ++j) {
      const double across = spacing * static_cast<double>(j);
      scene.initial.col(j * columns + i) << spacing * static_cast<double>(i), 1, across;
      scene.target.col(j * columns + i) << at, across - 0.8;
    }
    const double turn =
        1.8 * std::sin(2 * std::numbers::pi * spacing * (static_cast<double>(i) + 0.5));
    at += spacing * Eigen::Vector2d(std::cos(turn), std::sin(turn));
  }
  for (Index j = 0; j + 1 < columns; ++j) {
    for (Index i = 0; i + 1 < columns; ++i) {
      const Index corner = j * columns + i;
      scene.faces.push_back({corner, corner + 1, corner + columns + 1, corner + columns});
    }
  }
  return scene;
}

}  // namespace

Problem thrown_sheet(Index columns, double stretch_stiffness) {
  SheetScene scene = square_to_s(columns);
  scene.reference = Reference::morph;
  scene.damping_ratio = 0.7;
  scene.cloth.stretch_stiffness = stretch_stiffness;
  return make_problem(scene);
}

Problem released_sheet(Index columns) {
  SheetScene scene = square_to_s(columns);
  scene.cloth.air_drag = 0;
  scene.rest = Rest::flat;
  scene.initial = scene.target;
  scene.target.row(1).array() -= 0.5 * scene.gravity * scene.arrival_time * scene.arrival_time;
  return make_problem(scene);
}

std::vector<double> spread_gains(double scale, Index count) {
  std::vector<double> gains = {0};
  for (Index i = 1; i < count; ++i) {
    gains.push_back(scale *
                    std::pow(10, -1 + 3 * static_cast<double>(i) / static_cast<double>(count)));
  }
  return gains;
}

}  // namespace nuno::bench
