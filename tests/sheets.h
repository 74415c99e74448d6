#pragma once

#include <nuno/mesh.h>
#include <nuno/problem.h>

#include <cmath>
#include <string>

namespace nuno {

enum class Tiles {
  quads,
  triangles,  ///< with diagonals that alternate
  mixed       ///< quads, every third cut into triangles
};

/// A flat grid of columns × rows vertices, `spacing` apart, about the origin in the plane y = 0.
inline Mesh grid(Index columns, Index rows, double spacing, Tiles tiles = Tiles::quads) {
  Mesh mesh;
  mesh.vertices.resize(3, columns * rows);
  const auto at = [&](Index i, Index j) { return j * columns + i; };
  for (Index j = 0; j < rows; ++j) {
    for (Index i = 0; i < columns; ++i) {
      mesh.vertices.col(at(i, j)) << spacing * (static_cast<double>(i) -
                                                static_cast<double>(columns - 1) / 2),
          0, spacing * (static_cast<double>(j) - static_cast<double>(rows - 1) / 2);
    }
  }
  for (Index j = 0; j + 1 < rows; ++j) {
    for (Index i = 0; i + 1 < columns; ++i) {
      const Index a = at(i, j), b = at(i, j + 1), c = at(i + 1, j + 1), d = at(i + 1, j);
      if (tiles == Tiles::quads || (tiles == Tiles::mixed && (i + j) % 3 != 0)) {
        mesh.faces.push_back({a, b, c, d});
      } else if (tiles == Tiles::mixed || (i + j) % 2 == 0) {
        mesh.faces.push_back({a, b, c});
        mesh.faces.push_back({a, c, d});
      } else {
        mesh.faces.push_back({a, b, d});
        mesh.faces.push_back({b, c, d});
      }
    }
  }
  return mesh;
}

/// A flat shape in the plane y = 0, rolled up along x so that it turns by `angle` from its one end
/// to the other.
inline Points rolled(const Points& flat, double angle) {
  const double width = flat.row(0).maxCoeff() - flat.row(0).minCoeff();
  const double radius = width / angle;
  Points result = flat;
  for (Index i = 0; i < flat.cols(); ++i) {
    const double turn = flat(0, i) / radius;
    result(0, i) = radius * std::sin(turn);
    result(1, i) = radius * (1 - std::cos(turn));
  }
  return result;
}

/// A scene of an independent program's, in tests/data: square-to-halfpipe or disc-to-oblique.
inline SheetScene reference_sheet(const std::string& name) {
  const std::string path = NUNO_TEST_DATA "/sheets/" + name;
  const Mesh start = read_mesh(path + "-start.obj");
  SheetScene scene;
  scene.name = name;
  scene.arrival_time = 1;
  scene.initial = start.vertices;
  scene.faces = start.faces;
  scene.target = read_mesh(path + "-target.obj").vertices;
  return scene;
}

/// A problem with exactly this sheet, at rest as it lies; nothing pulls or brakes it unless the
/// material says so.
inline Problem problem_of(const Mesh& mesh, const SheetMaterial& material = {.air_drag = 0},
                          double gravity = 0, Rest rest = Rest::initial) {
  Problem problem;
  problem.form = make_sheet(mesh.vertices, mesh.faces, material, rest, gravity);
  problem.target = mesh.vertices;
  problem.arrival_time = 1;
  return problem;
}

/// A flat square sheet of columns × columns vertices that stays where it is.
inline SheetScene square(Index columns, double side, bool all_quads = true) {
  const Mesh mesh = grid(columns, columns, side / static_cast<double>(columns - 1),
                         all_quads ? Tiles::quads : Tiles::mixed);
  SheetScene scene;
  scene.arrival_time = 1;
  scene.initial = scene.target = mesh.vertices;
  scene.faces = mesh.faces;
  return scene;
}

/// A square of cloth thrown into a part of a tube, askew, under damped control: well-conditioned.
inline SheetScene throw_scene(bool all_quads = true, Index columns = 9) {
  SheetScene scene = square(columns, 0.8, all_quads);
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
