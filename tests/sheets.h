#pragma once

#include <nuno/problem.h>

#include <cmath>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>

namespace nuno {

/// A mesh as a test makes it or reads it.
struct Mesh {
  Points vertices;  ///< [3 × N], m
  Faces faces;
};

enum class Tiles { quads, triangles };

/// A flat grid of columns × rows vertices, `spacing` apart, about the origin in the plane y = 0;
/// triangles have diagonals that alternate.
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
      if (tiles == Tiles::quads) {
        mesh.faces.push_back({a, b, c, d});
      } else if ((i + j) % 2 == 0) {
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

/// The vertices and faces of a plain OBJ file: `v` and `f` with positions alone.
inline Mesh read_plain_obj(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error("cannot read " + path);
  std::vector<double> coordinates;
  Mesh mesh;
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string kind;
    words >> kind;
    if (kind == "v") {
      for (double x = 0; words >> x;) coordinates.push_back(x);
    } else if (kind == "f") {
      mesh.faces.emplace_back();
      for (Index i = 0; words >> i;) mesh.faces.back().push_back(i - 1);
    }
  }
  mesh.vertices =
      Eigen::Map<const Points>(coordinates.data(), 3, static_cast<Index>(coordinates.size() / 3));
  return mesh;
}

/// A scene of an independent program's, in tests/data: square-to-halfpipe or disc-to-oblique.
inline SheetScene reference_sheet(const std::string& name) {
  const std::string path = NUNO_TEST_DATA "/sheets/" + name;
  const Mesh start = read_plain_obj(path + "-start.obj");
  SheetScene scene;
  scene.name = name;
  scene.arrival_time = 1;
  scene.initial = start.vertices;
  scene.faces = start.faces;
  scene.target = read_plain_obj(path + "-target.obj").vertices;
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

}  // namespace nuno
