#pragma once

#include <nuno/scene.h>

#include <functional>
#include <vector>

/// Sheets that tests and demos share; all are made from numbers.
namespace nuno::scene_library {

struct FlatMesh {
  Points vertices;  ///< [3 × N], m
  Faces faces;
};

/// A flat grid in the plane y = 0, about the origin, of quads: lines at these x and z.
FlatMesh grid(const Vector& x, const Vector& z);
/// `columns` × `rows` vertices, evenly.
FlatMesh grid(double width, double depth, Index columns, Index rows);

/// A quad as two triangles, all cut the same way.
FlatMesh in_triangles(const FlatMesh& mesh);

/// A flat ring in the plane y = 0 about the origin, between two radii, of uneven triangles of about
/// this edge length; always the same one. A disc without its hole where `inner` is 0.
FlatMesh uneven_ring(double inner, double outer, double edge);

/// A flat mesh (y = 0) bent without stretching: lines at the angle `across` to the z axis stay
/// straight, and the direction of the way across them, u from the origin, is direction(u) above the
/// horizontal [rad], u in metres.
Points bent(const Points& flat, double across, const std::function<double(double u)>& direction);

/// Points turned by a rotation vector about the origin, then moved.
Points placed(const Points& points, const Eigen::Vector3d& turn, const Eigen::Vector3d& by);

/// The sheets of demos/scenes/sheets: a flag into a half pipe, a square into an S, a napkin folded
/// over an edge and a cape with a hole, bent without stretching; and a tablecloth into a saddle,
/// which no cloth fits exactly.
std::vector<SheetScene> sheets();

}  // namespace nuno::scene_library
