#include "pictures/drawn_result.h"

#include <fmt/format.h>

#include <nuno/scene.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "formats/compact_json.h"

namespace nuno {
namespace {

using Json = nlohmann::ordered_json;

// A flight may leave the bounds of its scene.
constexpr double largest_number = 1e3 * largest_scene_number;

/// A value of the file, which knows where it stands.
struct Field {
  const std::string& path;
  std::string pointer;
  const Json& value;

  [[noreturn]] void refuse(const std::string& rule) const {
    throw InputError(
        fmt::format("{}: {}: {} {}", path, pointer.empty() ? "/" : pointer, shown(value), rule));
  }
  Field child(const std::string& name) const {
    if (!value.is_object()) refuse("is not an object");
    const auto found = value.find(name);
    if (found == value.end()) {
      throw InputError(fmt::format("{}: {}/{}: is missing; it is required", path, pointer, name));
    }
    return {path, pointer + "/" + name, *found};
  }
  Field item(std::size_t i) const { return {path, fmt::format("{}/{}", pointer, i), value[i]}; }

  const Field& list(std::size_t least) const {
    if (!value.is_array()) refuse("is not a list");
    if (value.size() < least) refuse(fmt::format("has not at least {} items", least));
    return *this;
  }
  double number() const {
    if (!value.is_number()) refuse("is not a number");
    const auto result = value.get<double>();
    if (!(std::abs(result) <= largest_number)) {
      refuse(fmt::format("is not within ±{}", largest_number));
    }
    return result;
  }
  double not_negative() const {
    const double result = number();
    if (!(result >= 0)) refuse("is not >= 0");
    return result;
  }
  double positive() const {
    const double result = number();
    if (!(result > 0)) refuse("is not > 0");
    return result;
  }
  std::string text() const {
    if (!value.is_string()) refuse("is not a string");
    return value.get<std::string>();
  }
  Index index(Index count) const {
    const double result = number();
    if (!(result >= 0 && result < static_cast<double>(count) && result == std::floor(result))) {
      refuse(fmt::format("is not a whole number within 0 … {}", count - 1));
    }
    return static_cast<Index>(result);
  }
  /// A shape of `particles` points of `rows` numbers; of any number of them if `particles` is 0.
  Points points(Index particles, Index rows) const {
    if (!value.is_binary()) list(2);
    Points result = value.is_binary() ? points_of(value) : Points(rows, 0);
    const Index count = result.cols();
    if (count < 2) refuse("has not at least 2 items");
    if (particles > 0 && count != particles) {
      throw InputError(fmt::format("{}: {}: {} points are not {}, as many as in /target", path,
                                   pointer, count, particles));
    }
    const auto item_of = [&](const Json& json, Index i) -> Field {
      return {path, fmt::format("{}/{}", pointer, i), json};
    };
    if (result.rows() != rows) {
      const Json point(std::vector<double>(result.col(0).begin(), result.col(0).end()));
      item_of(point, 0).refuse(rows == 2 ? "is not a point [x, y]" : "is not a point [x, y, z]");
    }
    for (Index i = 0; i < count; ++i) {
      for (Index k = 0; k < rows; ++k) {
        if (std::abs(result(k, i)) <= largest_number) continue;
        const Json coordinate = result(k, i);
        (void)Field{path, fmt::format("{}/{}/{}", pointer, i, k), coordinate}.number();
      }
    }
    return result;
  }
};

/// A picture is at least as large as its target: one that is too small leaves no room for ticks.
void require_extent(const std::string& path, const Points& target) {
  const double extent = (target.rowwise().maxCoeff() - target.rowwise().minCoeff()).maxCoeff();
  if (!(extent >= smallest_scene_number &&
        extent >= smallest_relative_length * target.cwiseAbs().maxCoeff())) {
    throw InputError(
        fmt::format("{}: /target: an extent of {} is not >= {} and {} of its distance from the "
                    "origin",
                    path, extent, smallest_scene_number, smallest_relative_length));
  }
}

Faces faces_of(const Field& root, Index particles) {
  Faces result;
  const Field faces = root.child("faces").list(1);
  for (std::size_t f = 0; f < faces.value.size(); ++f) {
    const Field face = faces.item(f).list(3);
    std::vector<Index>& corners = result.emplace_back();
    for (std::size_t k = 0; k < face.value.size(); ++k) {
      corners.push_back(face.item(k).index(particles));
    }
  }
  return result;
}

/// The edges around a sheet's faces, some of them twice; a chain's segments, where there are none.
Edges edges_of(const Faces& faces, Index particles) {
  std::vector<std::pair<Index, Index>> ends;
  if (!faces.empty()) {
    for (const std::vector<Index>& face : faces) {
      for (std::size_t k = 0; k < face.size(); ++k) {
        ends.push_back(std::minmax({face[k], face[(k + 1) % face.size()]}));
      }
    }
    std::ranges::sort(ends);
    ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
  } else {
    for (Index i = 0; i + 1 < particles; ++i) ends.emplace_back(i, i + 1);
  }
  Edges edges(2, static_cast<Index>(ends.size()));
  for (Index e = 0; e < edges.cols(); ++e) {
    edges(0, e) = ends[static_cast<std::size_t>(e)].first;
    edges(1, e) = ends[static_cast<std::size_t>(e)].second;
  }
  return edges;
}

}  // namespace

bool is_scene(const std::string& text, const std::string& path) {
  return parse_compact(text, path, {.wanted = {"nuno_scene"}}).contains("nuno_scene");
}

figures::Flight parse_result(const std::string& text, const std::string& path) {
  static const JsonForm form = {
      .points = {{"/target", 0}, {"/final", 0}, {"/frames/positions", 1}},
      .wanted = {"nuno_result", "scene", "backend", "alpha", "kind", "size", "cloth_length",
                 "error", "faces", "target", "final", "frames"}};
  const Json json = parse_compact(text, path, form);
  const Field root{path, "", json};
  if (const Field version = root.child("nuno_result"); version.value != 1) {
    version.refuse("is not 1");
  }
  figures::Flight flight;
  flight.scene = root.child("scene").text();
  flight.backend = root.child("backend").text();
  flight.gain = root.child("alpha").not_negative();
  const bool is_sheet = json.contains("kind") && json["kind"] == "sheet";
  const Index rows = is_sheet ? 3 : 2;
  const Field cloth_length = root.child(is_sheet ? "size" : "cloth_length");
  flight.cloth_length = cloth_length.positive();
  if (!(flight.cloth_length >= smallest_scene_number)) {
    cloth_length.refuse(fmt::format("is not >= {}", smallest_scene_number));
  }
  const Field error = root.child("error");
  flight.error = error.child("mean").not_negative();
  flight.max_error = error.child("max").not_negative();
  flight.target = root.child("target").points(0, rows);
  require_extent(path, flight.target);
  const Index particles = flight.target.cols();
  if (is_sheet) flight.faces = faces_of(root, particles);
  flight.stroke = figures::stroke_along(edges_of(flight.faces, particles));
  (void)root.child("final").points(particles, rows);

  const Field frames = root.child("frames");
  const Field times = frames.child("times").list(2);
  const Field positions = frames.child("positions").list(2);
  if (positions.value.size() != times.value.size()) {
    throw InputError(fmt::format("{}: {}: {} frames are not {}, as many as in /frames/times", path,
                                 positions.pointer, positions.value.size(), times.value.size()));
  }
  for (std::size_t i = 0; i < times.value.size(); ++i) {
    const double time = times.item(i).not_negative();
    if (i > 0 && !(time > flight.times.back())) {
      times.item(i).refuse("is not later than the frame before");
    }
    flight.times.push_back(time);
    flight.positions.push_back(positions.item(i).points(particles, rows));
  }
  return flight;
}

}  // namespace nuno
