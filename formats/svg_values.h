#pragma once

#include <nuno/points.h>

#include <Eigen/Geometry>

#include <optional>
#include <pugixml.hpp>
#include <string>
#include <string_view>

#include "svg_path.h"

// The values of SVG's attributes. Everything here throws InputError for a value that breaks the
// grammar of SVG.

namespace nuno {

struct SvgValue;

/// An element's name without the prefix that some programs give to all of SVG.
std::string_view svg_kind(const pugi::xml_node& element);

/// An element, with what messages about it need.
struct SvgElement {
  const std::string& text;  ///< of the file, from which the document was read
  const std::string& source;
  pugi::xml_node node;

  /// The attribute; its text is empty where it is missing.
  SvgValue value(const char* attribute) const;
  /// A length, or none where it is missing or "auto"; a percentage is one of `whole`.
  std::optional<double> length(const char* attribute, double whole) const;
  /// Throws InputError, with the element's line, kind and id.
  [[noreturn]] void refuse(const std::string& what) const;
};

/// An attribute of an element.
struct SvgValue {
  SvgElement element;
  std::string_view attribute;
  std::string_view text;

  /// Throws InputError.
  [[noreturn]] void refuse(const std::string& rule) const;
};

/// The part of the plane that percentages are of; NaN where the file does not tell.
using Viewport = Eigen::Vector2d;

/// A length in user units (px): a number with or without a unit; a percentage is one of `whole`.
double svg_length(const SvgValue& value, double whole);

/// The attribute `transform`.
Eigen::Affine2d svg_transform(const SvgValue& value);

/// What `viewBox` shows in the viewport from `corner` on, as `preserve` (preserveAspectRatio, whose
/// text may be empty) wants it.
struct ViewBox {
  Eigen::Vector2d corner, size;
};
ViewBox svg_view_box(const SvgValue& value);
Eigen::Affine2d svg_fit(const ViewBox& box, const Eigen::Vector2d& corner, const Viewport& size,
                        const SvgValue& preserve);

/// The attribute `points` of a polyline.
SvgPath svg_points(const SvgValue& value);

/// The attribute `d`.
SvgPath svg_path(const SvgValue& value);

}  // namespace nuno
