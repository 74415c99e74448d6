#pragma once

#include <nuno/points.h>

#include <Eigen/Geometry>

#include <cstddef>
#include <vector>

// What an SVG element draws, in its own units, y down.

namespace nuno {

/// One piece of a path, over the parameter 0 … 1.
struct PathSegment {
  enum class Kind { line, quadratic, cubic, arc };
  Kind kind = Kind::line;
  /// The control points; of an arc the centre c, the half axes u and v, and the end point: it is
  /// c + cos θ·u + sin θ·v.
  Eigen::Matrix<double, 2, 4> points;
  double start_angle = 0;  ///< θ at the start of an arc [rad]
  double sweep = 0;        ///< what θ grows by over the arc [rad]
};

/// The most that a path may have: a tenth of a gigabyte, and no pen draws as many.
inline constexpr std::size_t most_svg_segments = 1'000'000;

/// A path, as the commands of SVG draw it.
class SvgPath {
 public:
  void move_to(const Eigen::Vector2d& to);
  void line_to(const Eigen::Vector2d& to);
  void quadratic_to(const Eigen::Vector2d& control, const Eigen::Vector2d& to);
  void cubic_to(const Eigen::Vector2d& first, const Eigen::Vector2d& second,
                const Eigen::Vector2d& to);
  /// Radii that are too small grow until the arc reaches; with one of 0 it is a line. SVG 2, 9.5.1.
  void arc_to(Eigen::Vector2d radii, double rotation, bool large, bool clockwise,
              const Eigen::Vector2d& to);
  void close();

  const Eigen::Vector2d& at() const { return at_; }        ///< where the next segment begins
  const Eigen::Vector2d& start() const { return start_; }  ///< of the subpath
  const Eigen::Vector2d& first() const { return first_; }  ///< where the first segment begins
  const std::vector<PathSegment>& segments() const { return segments_; }
  Index subpaths() const { return subpaths_; }  ///< of those that have a segment

 private:
  PathSegment& add(PathSegment::Kind kind, const Eigen::Vector2d& to);

  Eigen::Vector2d at_{0, 0}, start_{0, 0}, first_{0, 0};
  bool begins_ = true;  ///< the next segment is the first of its subpath
  std::vector<PathSegment> segments_;
  Index subpaths_ = 0;
};

/// The path [2 × any] after a map, no farther from its curves than 1e-6 of its length, which keeps
/// arc lengths along tight bends to a good 1e-5 as well. Without columns where nothing is drawn.
Points flattened(const SvgPath& path, const Eigen::Affine2d& map);

}  // namespace nuno
