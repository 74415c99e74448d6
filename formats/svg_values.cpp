#include "svg_values.h"

#include <nuno/scene.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "svg_scanner.h"
#include "text_file.h"

namespace nuno {
namespace {

using Eigen::Affine2d;
using Eigen::Vector2d;

struct Unit {
  std::string_view name;
  double px;
};
constexpr std::array<Unit, 8> units = {{{"", 1},
                                        {"px", 1},
                                        {"pt", 96.0 / 72},
                                        {"pc", 16},
                                        {"mm", 96 / 25.4},
                                        {"cm", 96 / 2.54},
                                        {"in", 96},
                                        {"Q", 96 / 101.6}}};

double radians(double degrees) { return degrees * std::numbers::pi / 180; }

Affine2d affine(double a, double b, double c, double d, double e, double f) {
  Affine2d map;
  map.matrix() << a, c, e, b, d, f, 0, 0, 1;
  return map;
}

Affine2d translation(double x, double y) { return affine(1, 0, 0, 1, x, y); }

/// One function of a list of transforms, with its numbers.
Affine2d transform_of(std::string_view name, const std::vector<double>& n, const SvgScanner& at) {
  const auto takes = [&](std::size_t least, std::size_t most) {
    return n.size() == least || n.size() == most;
  };
  if (name == "matrix" && takes(6, 6)) return affine(n[0], n[1], n[2], n[3], n[4], n[5]);
  if (name == "translate" && takes(1, 2)) return translation(n[0], n.size() > 1 ? n[1] : 0);
  if (name == "scale" && takes(1, 2)) return affine(n[0], 0, 0, n.back(), 0, 0);
  if (name == "rotate" && takes(1, 3)) {
    const double s = std::sin(radians(n[0])), c = std::cos(radians(n[0]));
    const Affine2d turn = affine(c, s, -s, c, 0, 0);
    return n.size() == 1 ? turn : translation(n[1], n[2]) * turn * translation(-n[1], -n[2]);
  }
  if (name == "skewX" && takes(1, 1)) return affine(1, 0, std::tan(radians(n[0])), 1, 0, 0);
  if (name == "skewY" && takes(1, 1)) return affine(1, std::tan(radians(n[0])), 0, 1, 0, 0);
  at.refuse(
      fmt::format("follows what is not matrix(6 numbers), translate(1 or 2), scale(1 or 2), "
                  "rotate(1 or 3), skewX(1) or skewY(1)"));
}

/// Where an alignment of preserveAspectRatio, "xMidYMax", puts the room that is left: 0, ½ or 1.
double share(std::string_view word) { return word == "Min" ? 0 : word == "Mid" ? 0.5 : 1; }

}  // namespace

std::string_view svg_kind(const pugi::xml_node& element) {
  std::string_view name = element.name();
  if (name.starts_with("svg:")) name.remove_prefix(4);
  return name;
}

SvgValue SvgElement::value(const char* attribute) const {
  return {*this, attribute, node.attribute(attribute).value()};
}

std::optional<double> SvgElement::length(const char* attribute, double whole) const {
  const SvgValue found = value(attribute);
  if (found.text.empty() || found.text == "auto") return std::nullopt;
  return svg_length(found, whole);
}

void SvgElement::refuse(const std::string& what) const {
  const auto offset =
      std::clamp<std::ptrdiff_t>(node.offset_debug(), 0, static_cast<std::ptrdiff_t>(text.size()));
  std::string name = shown_text(svg_kind(node));
  if (const std::string_view id = node.attribute("id").value(); !id.empty()) {
    name += fmt::format(" \"{}\"", shown_text(id));
  }
  throw InputError(fmt::format("{}:{}: {}: {}", source,
                               1 + std::count(text.begin(), text.begin() + offset, '\n'), name,
                               what));
}

void SvgValue::refuse(const std::string& rule) const {
  element.refuse(fmt::format("{}: \"{}\" {}", attribute, shown_text(text), rule));
}

double svg_length(const SvgValue& value, double whole) {
  SvgScanner scanner(value);
  scanner.skip_blanks();
  const double number = scanner.number();
  double px = whole / 100;
  if (!scanner.take('%')) {
    const std::string_view name = scanner.take_word();
    const auto* const unit = std::ranges::find(units, name, &Unit::name);
    if (unit == units.end()) {
      value.refuse("has a unit that is not px, pt, pc, mm, cm, in, Q or %");
    }
    px = unit->px;
  }
  scanner.skip_blanks();
  if (!scanner.at_end()) value.refuse("is not a length");
  if (!std::isfinite(px)) value.refuse("is a part of a page whose size the file does not tell");
  return number * px;
}

Affine2d svg_transform(const SvgValue& value) {
  Affine2d map = Affine2d::Identity();
  SvgScanner scanner(value);
  scanner.skip_blanks();
  while (!scanner.at_end()) {
    const std::string_view name = scanner.take_word();
    scanner.skip_blanks();
    std::vector<double> numbers;
    if (name.empty() || !scanner.take('(')) scanner.refuse("is not a transform: name(numbers)");
    for (bool more = scanner.has_more(); more; more = scanner.has_more()) {
      numbers.push_back(scanner.number());
      if (numbers.size() > 6) scanner.refuse("follows more than 6 numbers");
    }
    if (!scanner.take(')')) scanner.refuse("is not a number or )");
    map = map * transform_of(name, numbers, scanner);
    scanner.separator();
  }
  return map;
}

ViewBox svg_view_box(const SvgValue& value) {
  SvgScanner scanner(value);
  std::array<double, 4> n{};
  for (std::size_t i = 0; i < 4; ++i) {
    if (i == 0) scanner.skip_blanks();
    if (i > 0) scanner.separator();
    n[i] = scanner.number();
  }
  scanner.skip_blanks();
  if (!scanner.at_end()) value.refuse("is not 4 numbers: x, y, width, height");
  if (!(n[2] > 0 && n[3] > 0)) value.refuse("has not a width and a height > 0");
  return {{n[0], n[1]}, {n[2], n[3]}};
}

Affine2d svg_fit(const ViewBox& box, const Vector2d& corner, const Viewport& size,
                 const SvgValue& preserve) {
  std::string_view rest = preserve.text;
  std::string_view align = next_word(rest);
  if (align == "defer") align = next_word(rest);
  const std::string_view extent = next_word(rest);
  if (align.empty()) align = "xMidYMid";
  static constexpr std::array<std::string_view, 3> words = {"Min", "Mid", "Max"};
  const std::string_view x = align.substr(std::min<std::size_t>(1, align.size()), 3);
  const std::string_view y = align.substr(std::min<std::size_t>(5, align.size()));
  const bool aligned = align.size() == 8 && align[0] == 'x' && align[4] == 'Y' &&
                       std::ranges::count(words, x) > 0 && std::ranges::count(words, y) > 0;
  if ((!aligned && align != "none") || !next_word(rest).empty() ||
      (!extent.empty() && extent != "meet" && extent != "slice")) {
    preserve.refuse("is not none, or xMidYMid or the like, then meet or slice");
  }
  Vector2d scale = size.cwiseQuotient(box.size);
  if (aligned) {
    scale.setConstant(extent == "slice" ? scale.maxCoeff() : scale.minCoeff());
  }
  const Vector2d left = size - scale.cwiseProduct(box.size);
  const Vector2d shares = aligned ? Vector2d(share(x), share(y)) : Vector2d(0, 0);
  const Vector2d move = corner + shares.cwiseProduct(left) - scale.cwiseProduct(box.corner);
  return affine(scale.x(), 0, 0, scale.y(), move.x(), move.y());
}

SvgPath svg_points(const SvgValue& value) {
  SvgPath path;
  SvgScanner scanner(value);
  scanner.skip_blanks();
  if (scanner.at_end()) return path;
  bool first = true;
  do {
    const double x = scanner.number();
    scanner.separator();
    const Vector2d to(x, scanner.number());
    if (first) {
      path.move_to(to);
    } else {
      path.line_to(to);
    }
    first = false;
    if (path.segments().size() > most_svg_segments) {
      scanner.refuse(fmt::format("follows more than {} segments", most_svg_segments));
    }
  } while (scanner.has_more());
  if (!scanner.at_end()) scanner.refuse("is not a number");
  return path;
}

}  // namespace nuno
