// The grammar of the attribute `d`, SVG 2, chapter 9.3.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <numbers>

#include "svg_scanner.h"
#include "svg_values.h"

namespace nuno {
namespace {

using Eigen::Vector2d;

/// Draws one command after the other.
class PathReader {
 public:
  explicit PathReader(const SvgValue& value) : scanner_(value) {}

  SvgPath read() {
    bool first = true;
    for (scanner_.skip_blanks(); !scanner_.at_end(); scanner_.skip_blanks()) {
      static constexpr std::string_view letters = "MmLlHhVvCcSsQqTtAaZz";
      const char letter = scanner_.peek();
      if (letters.find(letter) == std::string_view::npos) {
        scanner_.refuse("is not a command of a path");
      }
      if (first && letter != 'M' && letter != 'm') scanner_.refuse("does not begin with M or m");
      first = false;
      scanner_.take();
      read_command(letter);
    }
    return std::move(path_);
  }

 private:
  /// A command with the arguments that follow it, once or again and again.
  void read_command(char letter) {
    relative_ = letter >= 'a';
    char kind = static_cast<char>(std::toupper(static_cast<unsigned char>(letter)));
    if (kind == 'Z') {
      path_.close();
      last_ = kind;
      return;
    }
    scanner_.skip_blanks();
    do {
      draw(kind);
      last_ = kind;
      if (kind == 'M') kind = 'L';  // further pairs are lines
      if (path_.segments().size() > most_svg_segments) {
        scanner_.refuse(fmt::format("follows more than {} segments", most_svg_segments));
      }
    } while (scanner_.has_more());
  }

  void draw(char kind) {
    switch (kind) {
      case 'M':
        return path_.move_to(point());
      case 'L':
        return path_.line_to(point());
      case 'H': {
        const double x = scanner_.number() + (relative_ ? path_.at().x() : 0);
        return path_.line_to({x, path_.at().y()});
      }
      case 'V': {
        const double y = scanner_.number() + (relative_ ? path_.at().y() : 0);
        return path_.line_to({path_.at().x(), y});
      }
      case 'C': {
        const Vector2d first = point();
        return draw_cubic(first, next_point());
      }
      case 'S': {
        const Vector2d first = mirrored_control("CS");
        return draw_cubic(first, point());
      }
      case 'Q': {
        const Vector2d control = point();
        return draw_quadratic(control, next_point());
      }
      case 'T': {
        const Vector2d control = mirrored_control("QT");
        return draw_quadratic(control, point());
      }
      default:
        return draw_arc();
    }
  }

  void draw_cubic(const Vector2d& first, const Vector2d& second) {
    path_.cubic_to(first, second, next_point());
    control_ = second;
  }

  void draw_quadratic(const Vector2d& control, const Vector2d& to) {
    path_.quadratic_to(control, to);
    control_ = control;
  }

  void draw_arc() {
    const double rx = scanner_.number();
    scanner_.separator();
    const double ry = scanner_.number();
    scanner_.separator();
    const double rotation = scanner_.number() * std::numbers::pi / 180;
    scanner_.separator();
    const bool large = scanner_.flag();
    scanner_.separator();
    const bool clockwise = scanner_.flag();
    path_.arc_to({rx, ry}, rotation, large, clockwise, next_point());
  }

  Vector2d point() {
    const double x = scanner_.number();
    scanner_.separator();
    const Vector2d offset = relative_ ? path_.at() : Vector2d(0, 0);
    return offset + Vector2d(x, scanner_.number());
  }

  Vector2d next_point() {
    scanner_.separator();
    return point();
  }

  /// The last control point mirrored at the place reached, if the last command was one of these.
  Vector2d mirrored_control(std::string_view of) const {
    if (of.find(last_) == std::string_view::npos) return path_.at();
    return 2 * path_.at() - control_;
  }

  SvgScanner scanner_;
  SvgPath path_;
  bool relative_ = false;
  char last_ = 'M';
  Vector2d control_{0, 0};
};

}  // namespace

SvgPath svg_path(const SvgValue& value) { return PathReader(value).read(); }

}  // namespace nuno
