#include "svg_shapes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace nuno {
namespace {

using Eigen::Vector2d;

/// The way round an ellipse from its right end, as the page's clock goes. SVG 2, 10.3.
SvgPath ellipse(const Vector2d& centre, const Vector2d& radii) {
  SvgPath path;
  if (!(radii.minCoeff() > 0)) return path;
  const Vector2d right(radii.x(), 0), below(0, radii.y());
  path.move_to(centre + right);
  for (const Vector2d& to : {below, Vector2d(-right), Vector2d(-below), right}) {
    path.arc_to(radii, 0, false, true, centre + to);
  }
  path.close();
  return path;
}

/// The way round a rectangle from the left end of its upper side. SVG 2, 10.2.
SvgPath rectangle(const Vector2d& corner, const Vector2d& size, const Vector2d& radii) {
  SvgPath path;
  if (!(size.minCoeff() > 0)) return path;
  const Vector2d end = corner + size;
  const double x = radii.x(), y = radii.y();
  path.move_to({corner.x() + x, corner.y()});
  const auto side = [&](const Vector2d& to, const Vector2d& round_to) {
    if (to != path.at()) path.line_to(to);
    path.arc_to(radii, 0, false, true, round_to);
  };
  side({end.x() - x, corner.y()}, {end.x(), corner.y() + y});
  side({end.x(), end.y() - y}, {end.x() - x, end.y()});
  side({corner.x() + x, end.y()}, {corner.x(), end.y() - y});
  side({corner.x(), corner.y() + y}, {corner.x() + x, corner.y()});
  path.close();
  return path;
}

double not_negative(const SvgElement& element, const char* attribute, double length) {
  if (!(length >= 0)) element.value(attribute).refuse("is not >= 0");
  return length;
}

SvgPath read_rectangle(const SvgElement& element, const Viewport& viewport) {
  const auto length = [&](const char* attribute, Index axis) {
    return element.length(attribute, viewport[axis]);
  };
  const Vector2d corner(length("x", 0).value_or(0), length("y", 1).value_or(0));
  const Vector2d size(not_negative(element, "width", length("width", 0).value_or(0)),
                      not_negative(element, "height", length("height", 1).value_or(0)));
  const std::optional<double> rx = length("rx", 0), ry = length("ry", 1);
  const Vector2d radii(not_negative(element, "rx", rx.value_or(ry.value_or(0))),
                       not_negative(element, "ry", ry.value_or(rx.value_or(0))));
  if (!(radii.minCoeff() > 0)) return rectangle(corner, size, {0, 0});
  return rectangle(corner, size, radii.cwiseMin(size / 2));
}

SvgPath read_ellipse(const SvgElement& element, const Viewport& viewport, bool circle) {
  const auto length = [&](const char* attribute, double whole) {
    return element.length(attribute, whole);
  };
  const Vector2d centre(length("cx", viewport.x()).value_or(0),
                        length("cy", viewport.y()).value_or(0));
  if (circle) {
    const double diagonal = viewport.norm() / std::sqrt(2);
    const double r = not_negative(element, "r", length("r", diagonal).value_or(0));
    return ellipse(centre, {r, r});
  }
  const std::optional<double> rx = length("rx", viewport.x()), ry = length("ry", viewport.y());
  return ellipse(centre, {not_negative(element, "rx", rx.value_or(ry.value_or(0))),
                          not_negative(element, "ry", ry.value_or(rx.value_or(0)))});
}

SvgPath read_line(const SvgElement& element, const Viewport& viewport) {
  const auto point = [&](const char* x, const char* y) {
    return Vector2d(element.length(x, viewport.x()).value_or(0),
                    element.length(y, viewport.y()).value_or(0));
  };
  SvgPath path;
  path.move_to(point("x1", "y1"));
  path.line_to(point("x2", "y2"));
  return path;
}

}  // namespace

bool is_svg_shape(std::string_view kind) {
  static constexpr std::array<std::string_view, 7> kinds = {"path", "line",   "polyline", "polygon",
                                                            "rect", "circle", "ellipse"};
  return std::ranges::find(kinds, kind) != kinds.end();
}

SvgPath svg_shape(const SvgElement& element, const Viewport& viewport) {
  const std::string_view kind = svg_kind(element.node);
  if (kind == "path") return svg_path(element.value("d"));
  if (kind == "line") return read_line(element, viewport);
  if (kind == "polyline") return svg_points(element.value("points"));
  if (kind == "polygon") {
    SvgPath path = svg_points(element.value("points"));
    path.close();
    return path;
  }
  if (kind == "rect") return read_rectangle(element, viewport);
  return read_ellipse(element, viewport, kind == "circle");
}

}  // namespace nuno
