#include "pictures/drawing.h"

#include <nuno/output.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace nuno::figures {
namespace {

struct Color {
  const char* name;
  const char* light;
  const char* dark;
};

// Series: Okabe and Ito's palette, which people tell apart whatever colours they see; dashes and
// markers say the same once more.
constexpr std::array<Color, 10> colors = {{
    {"paper", "#ffffff", "#14171a"},
    {"ink", "#1f2328", "#e8eaed"},
    {"muted", "#57606a", "#a0a9b3"},
    {"rule", "#8c959f", "#6b7580"},
    {"grid", "#e6e9ed", "#2a3036"},
    {"band", "#d3d8de", "#434b54"},
    {"a", "#0072b2", "#56b4e9"},
    {"b", "#d55e00", "#f0a030"},
    {"c", "#00825f", "#2fc79a"},
    {"d", "#b0558a", "#e08fbb"},
}};

std::string variables(bool dark) {
  std::string result = ":root{";
  for (const Color& color : colors) {
    result += fmt::format("--{}:{};", color.name, dark ? color.dark : color.light);
  }
  return result + "}";
}

/// A rule for a program that knows no variables, then for all others.
std::string paint(std::string_view property, std::string_view color) {
  const auto* const found = std::ranges::find(colors, color, &Color::name);
  return fmt::format("{0}:{1};{0}:var(--{2});", property, found->light, color);
}

constexpr double font_size = 12;
constexpr double spacing_of_obstacles = 4;
constexpr double half_a_band = 4;  // the style sheet's, near enough

bool overlap(const Box& a, const Box& b) {
  return a.left < b.right() && b.left < a.right() && a.top < b.bottom() && b.top < a.bottom();
}

bool is_inside(const Box& a, const Box& b) {
  return a.left >= b.left && a.right() <= b.right() && a.top >= b.top && a.bottom() <= b.bottom();
}

Box box_of_text(Vec at, double width, Anchor anchor) {
  const double shift = anchor == Anchor::start ? 0 : anchor == Anchor::middle ? 0.5 : 1;
  return {at.x - shift * width, at.y - 0.8 * font_size, width, 1.1 * font_size};
}

constexpr const char* anchor_name(Anchor anchor) {
  return anchor == Anchor::start ? "start" : anchor == Anchor::middle ? "middle" : "end";
}

}  // namespace

std::string style_sheet() {
  std::string css = variables(false);
  css += "@media (prefers-color-scheme:dark){" + variables(true) + "}";
  css += "@media print{" + variables(false) + "}";
  css +=
      "svg.figure text{font:12px system-ui,-apple-system,'Segoe UI',Roboto,'Helvetica Neue',Arial,"
      "'Noto Sans','DejaVu Sans',sans-serif;font-variant-numeric:tabular-nums;";
  css += paint("fill", "ink") + "stroke:none}";
  css += ".figure .title{font-size:15px;font-weight:600}";
  css += ".figure .strong{font-weight:600}";
  css += ".figure .muted{" + paint("fill", "muted") + "}";
  css += ".figure .paper{" + paint("fill", "paper") + "}";
  // Labels stay readable on a line.
  css += ".figure .label{paint-order:stroke;stroke-width:3.5px;stroke-linejoin:round;" +
         paint("stroke", "paper") + "}";
  css += ".figure .line{fill:none;stroke-width:1.5;stroke-linejoin:round;stroke-linecap:round;" +
         paint("stroke", "ink") + "}";
  css += ".figure .grid{stroke-width:1;" + paint("stroke", "grid") + "}";
  css += ".figure .rule{stroke-width:1;" + paint("stroke", "rule") + "}";
  css += ".figure .hair{stroke-width:.75;" + paint("stroke", "rule") + "}";
  css += ".figure .band{stroke-width:9;" + paint("stroke", "band") + "}";
  css += ".figure .soft{" + paint("stroke", "muted") + "}";
  css +=
      ".figure .thick{stroke-width:2.5}.figure .thin{stroke-width:1}.figure .bold{stroke-width:5}";
  css += ".figure .dots{stroke-dasharray:.1 4}.figure .dashes{stroke-dasharray:5 4}";
  css += ".figure .short{stroke-dasharray:3 3}.figure .long{stroke-dasharray:9 4}";
  css += ".figure .ghost{opacity:.35}.figure .mesh{stroke-width:3}";
  css += ".figure .dot{stroke-width:1.25;" + paint("stroke", "paper") + paint("fill", "ink") + "}";
  for (const char* series : {"a", "b", "c", "d"}) {
    css += fmt::format(".figure .line.{}{{{}}}", series, paint("stroke", series));
    css += fmt::format(".figure .dot.{}{{{}}}", series, paint("fill", series));
    css += fmt::format(".figure .dot.open.{}{{{}{}}}", series, paint("fill", "paper"),
                       paint("stroke", series));
  }
  css += ".figure .dot.soft{" + paint("fill", "muted") + paint("stroke", "paper") + "}";
  // A moving cloth, and what stands for it where things shall not move.
  css += ".figure .still{display:none}";
  css +=
      "@media (prefers-reduced-motion:reduce){.figure .moving{display:none}"
      ".figure .still{display:inline}}";
  css += "@media print{.figure .moving{display:none}.figure .still{display:inline}}";
  return css;
}

// A guess that holds for DejaVu Sans, one of the widest fonts; its digits are wider than letters.
double text_width(std::string_view text, std::string_view style) {
  const auto characters = static_cast<double>(std::ranges::count_if(
      text, [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; }));
  const auto is = [&](std::string_view part) { return style.find(part) != style.npos; };
  const double size = is("title") ? 15 : font_size;
  const bool number = text.find_first_not_of("0123456789.") == text.npos;
  return (number || is("title") || is("strong") ? 0.6 : 0.55) * size * characters;
}

std::string xml_text(std::string_view text) {
  std::string result;
  for (const char c : printable(std::string(text))) {
    if (c == '&') {
      result += "&amp;";
    } else if (c == '<') {
      result += "&lt;";
    } else if (c == '>') {
      result += "&gt;";
    } else if (c == '"') {
      result += "&quot;";
    } else {
      result += c;
    }
  }
  return result;
}

std::string svg_points(std::span<const Vec> points) {
  std::string result;
  for (const Vec& point : points) {
    // + 0.0 turns -0 into 0.
    result +=
        fmt::format("{}{:.6g},{:.6g}", result.empty() ? "" : " ",
                    std::round(100 * point.x) / 100 + 0.0, std::round(100 * point.y) / 100 + 0.0);
  }
  return result;
}

void Drawing::mind(Vec at, Weight weight) {
  if (weight != Weight::none) obstacles_.push_back({at, weight == Weight::heavy ? 1.0 : 0.25});
}

void Drawing::mind_line(Vec from, Vec to, Weight weight) {
  const double length = std::hypot(to.x - from.x, to.y - from.y);
  const int count = std::max(1, static_cast<int>(std::min(length, 4000.0) / spacing_of_obstacles));
  for (int i = 0; i < count; ++i) {
    const double s = (i + 0.5) / count;
    mind({from.x + s * (to.x - from.x), from.y + s * (to.y - from.y)}, weight);
  }
}

void Drawing::line(std::span<const Vec> points, std::string_view style, Weight weight) {
  if (points.empty()) return;
  body_ += fmt::format("<polyline class=\"line {}\" points=\"{}\"/>\n", style, svg_points(points));
  const bool is_band = style.find("band") != style.npos;
  for (std::size_t i = 1; i < points.size(); ++i) {
    const auto [from, to] = std::pair(points[i - 1], points[i]);
    mind_line(from, to, weight);
    if (!is_band) continue;
    const double along = half_a_band / std::max(1e-9, std::hypot(to.x - from.x, to.y - from.y));
    const Vec aside = {along * (from.y - to.y), along * (to.x - from.x)};
    for (const double side : {-1.0, 1.0}) {
      mind_line({from.x + side * aside.x, from.y + side * aside.y},
                {to.x + side * aside.x, to.y + side * aside.y}, weight);
    }
  }
}

void Drawing::line(Vec from, Vec to, std::string_view style, Weight weight) {
  line(std::array<Vec, 2>{from, to}, style, weight);
}

void Drawing::marker(Marker marker, Vec at, double size, std::string_view style, Weight weight) {
  const double r = size / 2;
  switch (marker) {
    case Marker::circle:
    case Marker::ring:
      body_ += fmt::format("<circle class=\"{} {}\" cx=\"{:.6g}\" cy=\"{:.6g}\" r=\"{:.4g}\"/>\n",
                           marker == Marker::ring ? "line" : "dot", style, at.x, at.y, r);
      break;
    case Marker::square:
      body_ += fmt::format(
          "<rect class=\"dot {}\" x=\"{:.6g}\" y=\"{:.6g}\" width=\"{:.4g}\" height=\"{:.4g}\"/>\n",
          style, at.x - 0.9 * r, at.y - 0.9 * r, 1.8 * r, 1.8 * r);
      break;
    case Marker::diamond:
      body_ += fmt::format(
          "<path class=\"dot {}\" d=\"M{:.6g} {:.6g}l{:.4g} {:.4g}l{:.4g} {:.4g}"
          "l{:.4g} {:.4g}z\"/>\n",
          style, at.x, at.y - 1.2 * r, 1.2 * r, 1.2 * r, -1.2 * r, 1.2 * r, -1.2 * r, -1.2 * r);
      break;
    case Marker::triangle:
      body_ += fmt::format("<path class=\"dot {}\" d=\"M{:.6g} {:.6g}l{:.4g} {:.4g}h{:.4g}z\"/>\n",
                           style, at.x, at.y - 1.2 * r, 1.15 * r, 2 * r, -2.3 * r);
      break;
  }
  for (const double dx : {-r, 0.0, r}) {
    for (const double dy : {-r, 0.0, r}) mind({at.x + dx, at.y + dy}, weight);
  }
}

void Drawing::text(Vec at, std::string_view text, Anchor anchor, std::string_view style) {
  body_ +=
      fmt::format("<text class=\"{}\" x=\"{:.6g}\" y=\"{:.6g}\" text-anchor=\"{}\">{}</text>\n",
                  style, at.x, at.y, anchor_name(anchor), xml_text(text));
  texts_.push_back(box_of_text(at, text_width(text, style), anchor));
}

void Drawing::vertical_text(Vec at, std::string_view text, std::string_view style) {
  body_ += fmt::format(
      "<text class=\"{}\" transform=\"translate({:.6g} {:.6g}) rotate(-90)\" "
      "text-anchor=\"middle\">{}</text>\n",
      style, at.x, at.y, xml_text(text));
}

void Drawing::rectangle(const Box& box, std::string_view style) {
  body_ += fmt::format(
      "<rect class=\"{}\" x=\"{:.6g}\" y=\"{:.6g}\" width=\"{:.6g}\" height=\"{:.6g}\"/>\n", style,
      box.left, box.top, box.width, box.height);
}

void Drawing::label(Vec place, std::string_view text, std::string_view style, const Box& inside) {
  labels_.push_back({place, std::string(text), std::string(style), inside});
}

void Drawing::begin_clip(const Box& box) {
  body_ += fmt::format(
      "<svg x=\"{0:.6g}\" y=\"{1:.6g}\" width=\"{2:.6g}\" height=\"{3:.6g}\" "
      "viewBox=\"{0:.6g} {1:.6g} {2:.6g} {3:.6g}\">\n",
      box.left, box.top, box.width, box.height);
}

void Drawing::end_clip() { body_ += "</svg>\n"; }

Drawing::Placement Drawing::placed(const Label& label, double distance, Vec way,
                                   const std::vector<Box>& taken) const {
  Placement result;
  result.distance = distance;
  result.way = way;
  result.anchor = way.x > 0.3 ? Anchor::start : way.x < -0.3 ? Anchor::end : Anchor::middle;
  result.at = {label.place.x + distance * way.x,
               label.place.y + distance * way.y + 0.35 * font_size + 0.45 * font_size * way.y};
  Box box = box_of_text(result.at, text_width(label.text, label.style), result.anchor);
  const double slid = std::max(label.inside.left - box.left, 0.0) +
                      std::min(label.inside.right() - box.right(), 0.0);
  result.at.x += slid;
  box.left += slid;
  result.cost = 0.045 * (distance + std::abs(slid)) + (way.y > 0 ? 0.1 : 0) +
                (std::abs(way.x) < 0.3 ? 0.1 : 0);
  if (!is_inside(box, label.inside)) result.cost += 1000;
  for (const Box& other : taken) {
    if (overlap(box, other)) result.cost += 100;
  }
  const Box wide = {box.left - 3, box.top - 1, box.width + 6, box.height + 2};
  for (const Obstacle& obstacle : obstacles_) {
    if (obstacle.at.x > wide.left && obstacle.at.x < wide.right() && obstacle.at.y > wide.top &&
        obstacle.at.y < wide.bottom()) {
      result.cost += obstacle.cost;
    }
  }
  return result;
}

Drawing::Placement Drawing::best_placement(const Label& label,
                                           const std::vector<Box>& taken) const {
  constexpr std::array<double, 7> distances = {7, 12, 20, 30, 44, 62, 84};
  constexpr int directions = 16;
  Placement best;
  best.cost = std::numeric_limits<double>::infinity();
  for (const double distance : distances) {
    for (int i = 0; i < directions; ++i) {
      const double angle = 2 * std::numbers::pi * i / directions;
      const Placement candidate =
          placed(label, distance, {std::cos(angle), -std::sin(angle)}, taken);
      if (candidate.cost < best.cost) best = candidate;
    }
  }
  return best;
}

std::string Drawing::placed_labels() const {
  std::string result;
  std::vector<Box> taken = texts_;
  for (const Label& label : labels_) {
    const Placement best = best_placement(label, taken);
    taken.push_back(box_of_text(best.at, text_width(label.text, label.style), best.anchor));
    if (best.distance > 15) {
      const std::array<Vec, 2> leader = {
          Vec{label.place.x + 5 * best.way.x, label.place.y + 5 * best.way.y},
          Vec{label.place.x + (best.distance - 3) * best.way.x,
              label.place.y + (best.distance - 3) * best.way.y}};
      result += fmt::format("<polyline class=\"line hair\" points=\"{}\"/>\n", svg_points(leader));
    }
    result += fmt::format(
        "<text class=\"label {}\" x=\"{:.6g}\" y=\"{:.6g}\" text-anchor=\"{}\">{}</text>\n",
        label.style, best.at.x, best.at.y, anchor_name(best.anchor), xml_text(label.text));
  }
  return result;
}

std::string Drawing::svg(bool with_style) const {
  std::string result = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"figure\" viewBox=\"0 0 {0:.6g} {1:.6g}\" "
      "width=\"{0:.6g}\" height=\"{1:.6g}\" role=\"img\">\n<title>{2}</title>\n",
      size_.x, size_.y, xml_text(title_));
  if (with_style) {
    result += "<style>" + style_sheet() + "</style>\n";
    result += "<rect class=\"paper\" width=\"100%\" height=\"100%\"/>\n";
  }
  return result + body_ + placed_labels() + "</svg>\n";
}

}  // namespace nuno::figures
