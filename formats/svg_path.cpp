#include "svg_path.h"

#include <nuno/scene.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace nuno {
namespace {

using Eigen::Vector2d;
using Kind = PathSegment::Kind;

/// Where a segment from `start` on is at the parameter t.
Vector2d point_at(const PathSegment& segment, const Vector2d& start, double t) {
  const double s = 1 - t;
  const auto& p = segment.points;
  switch (segment.kind) {
    case Kind::line:
      return s * start + t * p.col(3);
    case Kind::quadratic:
      return s * s * start + 2 * s * t * p.col(0) + t * t * p.col(3);
    case Kind::cubic:
      return s * s * s * start + 3 * s * s * t * p.col(0) + 3 * s * t * t * p.col(1) +
             t * t * t * p.col(3);
    case Kind::arc:
      break;
  }
  const double angle = segment.start_angle + t * segment.sweep;
  return p.col(0) + std::cos(angle) * p.col(1) + std::sin(angle) * p.col(2);
}

/// No less than the segment's second derivative by the parameter anywhere.
double largest_second_derivative(const PathSegment& segment, const Vector2d& start) {
  const auto& p = segment.points;
  switch (segment.kind) {
    case Kind::line:
      return 0;
    case Kind::quadratic:
      return 2 * (start - 2 * p.col(0) + p.col(3)).norm();
    case Kind::cubic:
      return 6 * std::max((start - 2 * p.col(0) + p.col(1)).norm(),
                          (p.col(0) - 2 * p.col(1) + p.col(3)).norm());
    case Kind::arc:
      break;
  }
  return segment.sweep * segment.sweep * std::hypot(p.col(1).norm(), p.col(2).norm());
}

PathSegment mapped(const PathSegment& segment, const Eigen::Affine2d& map) {
  PathSegment result = segment;
  result.points = map * segment.points;
  if (segment.kind == Kind::arc) {
    result.points.middleCols<2>(1) = map.linear() * segment.points.middleCols<2>(1);
  }
  return result;
}

double coarse_length(const PathSegment& segment, const Vector2d& start) {
  const int pieces = segment.kind == Kind::line ? 1 : 16;
  double length = 0;
  Vector2d last = start;
  for (int i = 1; i <= pieces; ++i) {
    const Vector2d next = point_at(segment, start, static_cast<double>(i) / pieces);
    length += (next - last).norm();
    last = next;
  }
  return length;
}

}  // namespace

PathSegment& SvgPath::add(Kind kind, const Vector2d& to) {
  if (begins_) ++subpaths_;
  if (segments_.empty()) first_ = at_;
  begins_ = false;
  PathSegment& segment = segments_.emplace_back();
  segment.kind = kind;
  segment.points = to.replicate<1, 4>();
  at_ = to;
  return segment;
}

void SvgPath::move_to(const Vector2d& to) {
  at_ = start_ = to;
  begins_ = true;
}

void SvgPath::line_to(const Vector2d& to) { add(Kind::line, to); }

void SvgPath::quadratic_to(const Vector2d& control, const Vector2d& to) {
  add(Kind::quadratic, to).points.col(0) = control;
}

void SvgPath::cubic_to(const Vector2d& first, const Vector2d& second, const Vector2d& to) {
  PathSegment& segment = add(Kind::cubic, to);
  segment.points.col(0) = first;
  segment.points.col(1) = second;
}

// In the frame of the half axes the ellipse is the unit circle: of its two centres that have both
// ends on the circle, "large" and "clockwise" choose one. SVG 2, appendix B.2.4.
void SvgPath::arc_to(Vector2d radii, double rotation, bool large, bool clockwise,
                     const Vector2d& to) {
  const Vector2d from = at_;
  if (from == to) return;
  radii = radii.cwiseAbs();
  Eigen::Matrix2d axes = Eigen::Rotation2Dd(rotation).toRotationMatrix() * radii.asDiagonal();
  const Eigen::Matrix2d to_circle =
      radii.cwiseInverse().asDiagonal() * Eigen::Rotation2Dd(-rotation).toRotationMatrix();
  Vector2d half_chord = to_circle * (from - to) / 2;
  const double reach = half_chord.norm();
  if (!(reach > 0) || !std::isfinite(reach) || !std::isfinite(1 / (reach * reach))) {
    return line_to(to);  // flat, or of no size beside its radii
  }
  Vector2d centre = Vector2d::Zero();  // from the chord's middle, on the circle
  if (reach >= 1) {
    axes *= reach;
    half_chord /= reach;
  } else {
    const double off = std::sqrt(1 / (reach * reach) - 1) * (large == clockwise ? -1 : 1);
    centre = off * Vector2d(half_chord.y(), -half_chord.x());
  }
  const Vector2d first = half_chord - centre, last = -half_chord - centre;
  const double start_angle = std::atan2(first.y(), first.x());
  double sweep = std::atan2(last.y(), last.x()) - start_angle;
  if (clockwise && sweep < 0) sweep += 2 * std::numbers::pi;
  if (!clockwise && sweep > 0) sweep -= 2 * std::numbers::pi;
  PathSegment& arc = add(Kind::arc, to);
  arc.points.col(0) = (from + to) / 2 + axes * centre;
  arc.points.middleCols<2>(1) = axes;
  arc.start_angle = start_angle;
  arc.sweep = sweep;
}

void SvgPath::close() {
  if (!begins_ && at_ != start_) line_to(start_);
  move_to(start_);
}

// A chord of n over the parameter is off by |f″|/(8·n²) at most.
Points flattened(const SvgPath& path, const Eigen::Affine2d& map) {
  if (path.segments().empty()) return Points(2, 0);
  std::vector<PathSegment> segments;
  segments.reserve(path.segments().size());
  for (const PathSegment& each : path.segments()) segments.push_back(mapped(each, map));
  const Vector2d start = map * path.first();
  double length = 0;
  Vector2d at = start;
  for (const PathSegment& each : segments) {
    length += coarse_length(each, at);
    at = each.points.col(3);
  }
  constexpr double tolerance = 1e-6;  // of the length
  // A path that is all but a point is refused by the scene: one chord is as good as many.
  const double least = smallest_relative_length * start.cwiseAbs().maxCoeff();
  std::vector<double> points = {start.x(), start.y()};
  at = start;
  for (const PathSegment& each : segments) {
    const double bend = largest_second_derivative(each, at) / (8 * tolerance * length);
    const int count = length > least && std::isfinite(bend)
                          ? std::max(1, static_cast<int>(std::ceil(std::sqrt(bend))))
                          : 1;
    for (int i = 1; i < count; ++i) {
      const Vector2d next = point_at(each, at, static_cast<double>(i) / count);
      points.insert(points.end(), {next.x(), next.y()});
    }
    at = each.points.col(3);
    points.insert(points.end(), {at.x(), at.y()});
  }
  return Eigen::Map<const Points>(points.data(), 2, static_cast<Index>(points.size() / 2));
}

}  // namespace nuno
