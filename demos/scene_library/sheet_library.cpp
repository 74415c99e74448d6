#include "sheet_library.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace nuno::scene_library {
namespace {

using std::numbers::pi;

/// A ring's vertices, in the order of their angles, and what they are called in the mesh.
struct Ring {
  Index first;
  std::vector<double> angles;

  Index vertex(std::size_t i) const { return first + static_cast<Index>(i % angles.size()); }
  double angle(std::size_t i) const {
    return angles[i % angles.size()] + (i >= angles.size() ? 2 * pi : 0);
  }
};

/// Triangles between two rings, going round both at once.
void join(const Ring& inner, const Ring& outer, Faces& faces) {
  std::size_t i = inner.angles.size() == 1 ? 1 : 0, o = 0;  // a middle has no edges of its own
  while (i < inner.angles.size() || o < outer.angles.size()) {
    const bool step_in = o >= outer.angles.size() ||
                         (i < inner.angles.size() && inner.angle(i + 1) < outer.angle(o + 1));
    faces.push_back(
        {inner.vertex(i), outer.vertex(o), step_in ? inner.vertex(i + 1) : outer.vertex(o + 1)});
    (step_in ? i : o) += 1;
  }
}

}  // namespace

FlatMesh grid(const Vector& x, const Vector& z) {
  const Index columns = x.size(), rows = z.size();
  FlatMesh mesh;
  mesh.vertices.resize(3, columns * rows);
  for (Index row = 0; row < rows; ++row) {
    for (Index column = 0; column < columns; ++column) {
      const Index at = row * columns + column;
      mesh.vertices.col(at) << x[column], 0, z[row];
      if (row + 1 == rows || column + 1 == columns) continue;
      mesh.faces.push_back({at, at + columns, at + columns + 1, at + 1});
    }
  }
  return mesh;
}

FlatMesh grid(double width, double depth, Index columns, Index rows) {
  return grid(Vector::LinSpaced(columns, -0.5 * width, 0.5 * width),
              Vector::LinSpaced(rows, -0.5 * depth, 0.5 * depth));
}

FlatMesh in_triangles(const FlatMesh& mesh) {
  FlatMesh result;
  result.vertices = mesh.vertices;
  for (const auto& f : mesh.faces) {
    result.faces.push_back({f[0], f[1], f[2]});
    if (f.size() == 4) result.faces.push_back({f[0], f[2], f[3]});
  }
  return result;
}

FlatMesh uneven_ring(double inner, double outer, double edge) {
  std::vector<Eigen::Vector3d> vertices;
  const auto spans = std::max<Index>(1, std::lround((outer - inner) / edge));
  FlatMesh mesh;
  Ring last{0, {}};
  for (Index k = 0; k <= spans; ++k) {
    const double share = static_cast<double>(k) / static_cast<double>(spans);
    const double radius = inner + share * (outer - inner);
    const bool is_border = k == spans || k == 0;
    const auto count =
        radius == 0 ? 1 : static_cast<std::size_t>(std::lround(2 * pi * radius / edge));
    Ring ring{static_cast<Index>(vertices.size()), {}};
    for (std::size_t i = 0; i < count; ++i) {
      // Uneven by up to a fifth of an edge, by a pattern of all wavelengths.
      const auto n = static_cast<double>(vertices.size());
      const double angle =
          2 * pi * (static_cast<double>(i) + 0.2 * std::sin(1.7 * n * n) + (k % 2 == 0 ? 0 : 0.5)) /
          static_cast<double>(count);
      const double r = is_border ? radius : radius + 0.2 * edge * std::sin(2.3 * n * n);
      vertices.emplace_back(r * std::cos(angle), 0, -r * std::sin(angle));
      ring.angles.push_back(angle);
    }
    if (k > 0) join(last, ring, mesh.faces);
    last = ring;
  }
  mesh.vertices.resize(3, static_cast<Index>(vertices.size()));
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    mesh.vertices.col(static_cast<Index>(i)) = vertices[i];
  }
  return mesh;
}

Points bent(const Points& flat, double across, const std::function<double(double)>& direction) {
  const double c = std::cos(across), s = std::sin(across);
  Points result(3, flat.cols());
  for (Index i = 0; i < flat.cols(); ++i) {
    const double u = c * flat(0, i) + s * flat(2, i), v = c * flat(2, i) - s * flat(0, i);
    constexpr int pieces = 400;  // midpoint rule: to 1e-6 of a curve that turns a few times
    double along = 0, up = 0;
    for (int k = 0; k < pieces; ++k) {
      const double angle = direction(u * (k + 0.5) / pieces);
      along += u / pieces * std::cos(angle);
      up += u / pieces * std::sin(angle);
    }
    result.col(i) << c * along - s * v, up, s * along + c * v;
  }
  return result;
}

Points placed(const Points& points, const Eigen::Vector3d& turn, const Eigen::Vector3d& by) {
  const double angle = turn.norm();
  const Eigen::Vector3d axis = angle > 0 ? Eigen::Vector3d(turn / angle) : Eigen::Vector3d::UnitX();
  const Eigen::Matrix3d rotation = Eigen::AngleAxis<double>(angle, axis).toRotationMatrix();
  return (rotation * points).colwise() + by;
}

namespace {

const Eigen::Vector3d upright(pi / 2, 0, 0);  ///< turns what lies in y = 0 to stand in z = 0

/// A sheet from a flat pose to a target [3 × N].
SheetScene sheet(const char* name, double arrival_time, const FlatMesh& mesh, const Points& initial,
                 const Points& target) {
  SheetScene scene;
  scene.name = name;
  scene.arrival_time = arrival_time;
  scene.initial = initial;
  scene.target = target;
  scene.faces = mesh.faces;
  scene.reference = Reference::morph;
  scene.damping_ratio = 0.7;
  return scene;
}

SheetScene flag() {
  const FlatMesh mesh = grid(1.2, 0.8, 19, 13);
  const Points pipe = bent(mesh.vertices, 0, [](double u) { return pi / 1.2 * u; });
  return sheet("flag-to-half-pipe", 1.2, mesh, placed(mesh.vertices, upright, {0, 1.5, 0}),
               placed(pipe, {0, 0.6, 0}, {3, 0.8, 0.6}));
}

SheetScene square() {
  const FlatMesh mesh = grid(1, 1, 17, 17);
  const Points s = bent(mesh.vertices, 0, [](double u) { return std::cos(2 * pi * u); });
  return sheet("square-to-s", 1.2, mesh, placed(mesh.vertices, {0, 0, 0}, {0, 1, 0}),
               placed(s, {0.5, 0.3, 0.9}, {3, 1.5, -0.5}));
}

/// Lines that stand closer where the fold will be.
SheetScene napkin() {
  constexpr double half = 0.25, fold = 0.07;  // half the side and half the arc of the fold [m]
  Vector x(19);
  x << Vector::LinSpaced(5, -half, -fold).head(4), Vector::LinSpaced(11, -fold, fold),
      Vector::LinSpaced(5, fold, half).tail(4);
  const FlatMesh mesh = grid(x, Vector::LinSpaced(13, -half, half));
  const Points folded = bent(mesh.vertices, 0, [](double u) {
    return -0.28 * pi * std::clamp(u / fold, -1.0, 1.0);  // by 101°
  });
  return sheet("napkin-over-an-edge", 1.5, mesh, placed(mesh.vertices, {0, 0, 0}, {0, 1, 0}),
               placed(folded, {0, 0.4, 0}, {1.5, 0.7, 0.3}));
}

SheetScene cape() {
  const FlatMesh mesh = uneven_ring(0.14, 0.6, 0.07);
  const Points worn = bent(mesh.vertices, 0.3, [](double u) { return -0.8 * pi * u; });
  return sheet("cape-with-a-hole", 1, mesh, placed(mesh.vertices, upright, {0, 1.2, 0}),
               placed(worn, {0.2, -0.3, 0}, {2.5, 1.4, 0}));
}

SheetScene tablecloth() {
  const FlatMesh mesh = in_triangles(grid(1, 1, 15, 15));
  Points saddle = mesh.vertices;
  saddle.row(1) = 0.5 * (saddle.row(0).array().square() - saddle.row(2).array().square()).matrix();
  return sheet("tablecloth-to-saddle", 1, mesh, placed(mesh.vertices, {0, 0, 0}, {0, 1, 0}),
               placed(saddle, {0, 0.5, 0}, {2.5, 1.2, 0}));
}

}  // namespace

std::vector<SheetScene> sheets() { return {flag(), square(), napkin(), cape(), tablecloth()}; }

}  // namespace nuno::scene_library
