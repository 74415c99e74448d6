#include <nuno/drawing.h>
#include <nuno/input.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <vector>

#include "encoding.h"
#include "text_file.h"

namespace nuno {
namespace {

constexpr std::array<std::string_view, 3> extensions = {".svg", ".obj", ".csv"};

/// Whether a path ends so, in any case.
bool has_extension(std::string_view path, std::string_view extension) {
  return path.size() > extension.size() &&
         std::ranges::equal(
             path.substr(path.size() - extension.size()), extension,
             [](char a, char b) { return (a >= 'A' && a <= 'Z' ? a + 32 : a) == b; });
}

bool is_drawing_path(std::string_view path) {
  return std::ranges::any_of(extensions, [&](auto each) { return has_extension(path, each); });
}

/// FILE#NAME taken apart.
struct CurveName {
  std::string path;
  std::string name;  ///< empty: the only one
};

CurveName curve_name(const std::string& curve) {
  for (std::size_t hash = curve.find('#'); hash != std::string::npos;
       hash = curve.find('#', hash + 1)) {
    if (is_drawing_path(curve.substr(0, hash))) {
      return {curve.substr(0, hash), curve.substr(hash + 1)};
    }
  }
  return {curve, ""};
}

/// Whether an OBJ text has lines and no faces.
bool has_only_lines(const std::string& text, const std::string& source) {
  bool lines = false, faces = false;
  for_each_obj_line(text, source, [&](std::string_view words, const Line&) {
    const std::string_view word = next_word(words);
    lines = lines || word == "l";
    faces = faces || word == "f" || word == "fo";
  });
  return lines && !faces;
}

}  // namespace

bool is_drawing(const std::string& curve) {
  const CurveName asked = curve_name(curve);
  if (!is_drawing_path(asked.path)) return false;
  if (!has_extension(asked.path, ".obj")) return true;
  return has_only_lines(read_file(asked.path, asked.path, "a mesh or a drawing", largest_file),
                        asked.path);
}

Points read_curve(const std::string& curve) {
  const auto [path, name] = curve_name(curve);
  if (!is_drawing_path(path)) {
    throw InputError(fmt::format("{}: does not end in {}", path, fmt::join(extensions, ", ")));
  }
  const std::string text = read_file(path, path, "a drawing", largest_file);
  require_text(text, path);
  if (has_extension(path, ".svg")) return parse_svg(text, path, name);
  if (has_extension(path, ".obj")) return parse_obj_curve(text, path, name);
  if (!name.empty()) {
    throw InputError(fmt::format("{}: \"{}\" is not a curve of it: a .csv has only one", path,
                                 shown_text(name)));
  }
  return parse_csv(text, path);
}

Points parse_csv(const std::string& text, const std::string& source) {
  std::vector<double> points;
  Line line{source};
  for (std::size_t start = 0; start < text.size();) {
    const std::size_t end = std::min(text.find('\n', start), text.size());
    std::string_view row(text.data() + start, end - start);
    start = end + 1;
    if (++line.number == 1 && row.starts_with("\xEF\xBB\xBF")) row.remove_prefix(3);
    row = row.substr(0, row.find('#'));
    const std::size_t comma = row.find_first_of(",;");
    std::string_view first = row.substr(0, comma);
    std::string_view second = comma == std::string_view::npos ? "" : row.substr(comma + 1);
    std::string_view& rest = comma == std::string_view::npos ? first : second;
    const std::string_view x = next_word(first), y = next_word(rest);
    if (x.empty() && y.empty()) continue;
    const bool is_title = points.empty() && x.find_first_of("0123456789") == x.npos;
    if (is_title) continue;
    if (y.empty() || !next_word(first).empty() || !next_word(rest).empty()) {
      line.refuse(row, "is not two numbers: x,y");
    }
    points.push_back(number(x, line));
    points.push_back(number(y, line));
  }
  if (points.empty()) throw InputError(fmt::format("{}: has no point x,y", source));
  return Eigen::Map<const Points>(points.data(), 2, static_cast<Index>(points.size() / 2));
}

ChainScene with_drawings(ChainScene scene, const std::string& initial, const std::string& target,
                         const std::string& source) {
  scene.initial = read_curve(initial);
  scene.target = read_curve(target);
  validate(scene, source);
  return scene;
}

}  // namespace nuno
