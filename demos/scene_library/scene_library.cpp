#include "scene_library.h"

#include <fmt/format.h>

#include <array>
#include <cassert>
#include <cmath>
#include <numbers>
#include <random>

namespace nuno::scene_library {
namespace {

using std::numbers::pi;

constexpr Index curve_points = 257;

/// Numbers that are the same with every standard library (its distributions are not).
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double uniform(double from, double to) {
    return from + (to - from) * (static_cast<double>(engine_() >> 11) * 0x1p-53);
  }
  double log_uniform(double from, double to) { return from * std::pow(to / from, uniform(0, 1)); }

 private:
  std::mt19937_64 engine_;
};

/// Integrates a direction over a length; the curve's centroid is placed on `center`.
template <typename Direction>
Points integrate(Direction direction, double length, const Vector& center) {
  Points points = Points::Zero(2, curve_points);
  const double ds = 1.0 / static_cast<double>(curve_points - 1);
  for (Index i = 1; i < curve_points; ++i) {
    const double angle = direction((static_cast<double>(i) - 0.5) * ds);
    points.col(i) =
        points.col(i - 1) + length * ds * Eigen::Vector2d(std::cos(angle), std::sin(angle));
  }
  return shape_of(points).colwise() + center;
}

/// A curve of smooth random curvature that turns by at most `turning`.
Points random_curve(Random& random, double turning, double length, const Vector& center) {
  const double tilt = random.uniform(-pi / 4, pi / 4);
  std::array<double, 3> amplitude{};
  std::array<double, 3> phase{};
  for (std::size_t k = 0; k < 3; ++k) {
    amplitude[k] = random.uniform(-1, 1) / static_cast<double>(k + 1);
    phase[k] = random.uniform(0, 2 * pi);
  }
  const auto wave = [&](double s) {
    double sum = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      sum += amplitude[k] * std::sin(pi * static_cast<double>(k + 1) * s + phase[k]);
    }
    return sum;
  };
  double low = wave(0), high = wave(0);
  for (int i = 1; i <= 256; ++i) {
    low = std::min(low, wave(i / 256.0));
    high = std::max(high, wave(i / 256.0));
  }
  const double gain = random.uniform(0.2, 1) * turning / (high - low);
  const double middle = 0.5 * (low + high);
  return integrate([&](double s) { return tilt + gain * (wave(s) - middle); }, length, center);
}

/// Straight strokes of equal length in the given directions: a drawing with sharp corners.
template <std::size_t n>
Points strokes(const std::array<double, n>& directions, const std::array<double, n>& lengths,
               const Vector& center) {
  Points points = Points::Zero(2, n + 1);
  for (std::size_t i = 0; i < n; ++i) {
    const auto column = static_cast<Index>(i);
    points.col(column + 1) =
        points.col(column) +
        lengths[i] * Eigen::Vector2d(std::cos(directions[i]), std::sin(directions[i]));
  }
  return shape_of(points).colwise() + center;
}

Points sharp_target(std::uint64_t which, const Vector& center) {
  switch (which % 3) {
    case 0:  // a fold of 90°
      return strokes<2>({pi / 4, -pi / 4}, {0.5, 0.5}, center);
    case 1:  // the letter Z
      return strokes<3>({0, -3 * pi / 4, 0}, {0.3, 0.4, 0.3}, center);
    default:  // a hairpin: there and back, 4 cm apart
      return strokes<3>({0, -pi / 2, -pi}, {0.48, 0.04, 0.48}, center);
  }
}

}  // namespace

namespace {

/// A drawn figure: points of a polyline, with sharp or smooth corners.
struct Drawing {
  std::string_view name;
  bool sharp;
  std::vector<Eigen::Vector2d> points;
};

const std::vector<Drawing>& drawings() {
  static const std::vector<Drawing> all = {
      {"C",
       false,
       {{0.9, 0.85}, {0.5, 1}, {0.1, 0.75}, {0, 0.5}, {0.1, 0.25}, {0.5, 0}, {0.9, 0.15}}},
      {"J", false, {{0.7, 1}, {0.7, 0.6}, {0.68, 0.25}, {0.45, 0}, {0.15, 0.1}, {0.05, 0.3}}},
      {"L", true, {{0, 1}, {0, 0}, {0.7, 0}}},
      {"M", true, {{0, 0}, {0.1, 1}, {0.5, 0.3}, {0.9, 1}, {1, 0}}},
      {"N", true, {{0, 0}, {0, 1}, {0.7, 0}, {0.7, 1}}},
      {"O",
       false,
       {{0.5, 1},
        {0.13, 0.85},
        {0, 0.5},
        {0.13, 0.15},
        {0.5, 0},
        {0.87, 0.15},
        {1, 0.5},
        {0.87, 0.85},
        {0.6, 0.98}}},
      {"S",
       false,
       {{0.75, 0.85},
        {0.45, 1},
        {0.12, 0.85},
        {0.2, 0.6},
        {0.6, 0.42},
        {0.7, 0.18},
        {0.4, 0},
        {0.05, 0.15}}},
      {"U", false, {{0, 1}, {0, 0.5}, {0.1, 0.12}, {0.4, 0}, {0.7, 0.12}, {0.8, 0.5}, {0.8, 1}}},
      {"V", true, {{0, 1}, {0.4, 0}, {0.8, 1}}},
      {"W", true, {{0, 1}, {0.25, 0}, {0.5, 0.8}, {0.75, 0}, {1, 1}}},
      {"Z", true, {{0, 1}, {0.8, 1}, {0, 0}, {0.8, 0}}},
      {"2",
       false,
       {{0.05, 0.75},
        {0.3, 1},
        {0.65, 0.85},
        {0.6, 0.55},
        {0.25, 0.2},
        {0.02, 0.02},
        {0.35, 0.04},
        {0.7, 0}}},
      {"3",
       false,
       {{0.1, 0.9},
        {0.4, 1},
        {0.65, 0.8},
        {0.5, 0.58},
        {0.35, 0.52},
        {0.6, 0.42},
        {0.72, 0.2},
        {0.4, 0},
        {0.05, 0.12}}},
      {"6",
       false,
       {{0.6, 0.95},
        {0.25, 0.75},
        {0.05, 0.4},
        {0.15, 0.08},
        {0.45, 0},
        {0.68, 0.2},
        {0.55, 0.45},
        {0.25, 0.42}}},
      {"arch",
       false,
       {{0, 0}, {0.05, 0.35}, {0.25, 0.65}, {0.5, 0.75}, {0.75, 0.65}, {0.95, 0.35}, {1, 0}}},
      {"hook", false, {{0, 0}, {0.3, 0.02}, {0.6, 0.08}, {0.85, 0.3}, {0.8, 0.6}, {0.5, 0.65}}},
      {"line", true, {{0, 0}, {1, 0}}},
      {"spiral",
       false,
       {{0.55, 0.5},
        {0.45, 0.58},
        {0.36, 0.48},
        {0.45, 0.34},
        {0.64, 0.36},
        {0.74, 0.55},
        {0.6, 0.78},
        {0.3, 0.76},
        {0.13, 0.5},
        {0.25, 0.17},
        {0.6, 0.08}}},
      {"wave",
       false,
       {{0, 0},
        {0.15, 0.2},
        {0.3, 0},
        {0.45, -0.2},
        {0.6, 0},
        {0.75, 0.2},
        {0.9, 0},
        {1.05, -0.2}}},
      {"infinity",
       false,
       {{0.5, 0.5},
        {0.75, 0.7},
        {0.98, 0.5},
        {0.75, 0.3},
        {0.5, 0.5},
        {0.25, 0.7},
        {0.02, 0.5},
        {0.22, 0.32}}},
  };
  return all;
}

/// A smooth curve through the points (Catmull–Rom, 24 pieces a span).
Points through(const std::vector<Eigen::Vector2d>& points) {
  constexpr Index pieces = 24;
  const auto last = static_cast<Index>(points.size()) - 1;
  const auto at = [&](Index i) -> Eigen::Vector2d {
    if (i < 0) return 2 * points.front() - points[1];
    if (i > last) return 2 * points.back() - points[static_cast<std::size_t>(last - 1)];
    return points[static_cast<std::size_t>(i)];
  };
  Points curve(2, last * pieces + 1);
  for (Index i = 0; i < last; ++i) {
    for (Index k = 0; k < pieces; ++k) {
      const double u = static_cast<double>(k) / static_cast<double>(pieces);
      curve.col(i * pieces + k) =
          0.5 * (2 * at(i) + u * (at(i + 1) - at(i - 1)) +
                 u * u * (2 * at(i - 1) - 5 * at(i) + 4 * at(i + 1) - at(i + 2)) +
                 u * u * u * (3 * at(i) - at(i - 1) - 3 * at(i + 1) + at(i + 2)));
    }
  }
  curve.col(last * pieces) = at(last);
  return curve;
}

}  // namespace

Points figure(std::string_view name) {
  for (const Drawing& drawing : drawings()) {
    if (drawing.name != name) continue;
    Points points;
    if (drawing.sharp) {
      points.resize(2, static_cast<Index>(drawing.points.size()));
      for (Index i = 0; i < points.cols(); ++i) {
        points.col(i) = drawing.points[static_cast<std::size_t>(i)];
      }
    } else {
      points = through(drawing.points);
    }
    return shape_of(points) / segment_lengths(points).sum();
  }
  assert(!"no figure of that name");
  return {};
}

const std::vector<std::string_view>& figure_names() {
  static const std::vector<std::string_view> names = [] {
    std::vector<std::string_view> result;
    for (const Drawing& drawing : drawings()) result.push_back(drawing.name);
    return result;
  }();
  return names;
}

std::vector<ChainScene> figure_throws() {
  constexpr std::array<std::array<std::string_view, 2>, 20> throws = {{
      {"line", "C"}, {"line", "J"},      {"line", "M"},        {"line", "N"},    {"line", "S"},
      {"line", "U"}, {"line", "W"},      {"line", "Z"},        {"line", "2"},    {"line", "3"},
      {"line", "6"}, {"line", "spiral"}, {"line", "infinity"}, {"arch", "wave"}, {"S", "2"},
      {"C", "S"},    {"U", "arch"},      {"L", "V"},           {"wave", "O"},    {"hook", "spiral"},
  }};
  std::vector<ChainScene> scenes;
  for (std::size_t i = 0; i < throws.size(); ++i) {
    ChainScene scene;
    scene.name = fmt::format("{}-to-{}", throws[i][0], throws[i][1]);
    scene.arrival_time = 0.6 + 0.6 * static_cast<double>(i % 4) / 3;
    scene.initial = figure(throws[i][0]).colwise() + Eigen::Vector2d(0, 1);
    scene.target = figure(throws[i][1]).colwise() + Eigen::Vector2d(2.5, 1.5);
    scenes.push_back(std::move(scene));
  }
  return scenes;
}

Points curve_from_direction(double (*direction)(double s), double length, const Vector& center) {
  return integrate(direction, length, center);
}

ChainScene straight_to_s() {
  ChainScene scene;
  scene.name = "straight-to-s";
  scene.arrival_time = 1;
  scene.initial.resize(2, 2);
  scene.initial << 0, 1, 1, 1;
  scene.target = curve_from_direction([](double s) { return 1.2 * std::sin(2 * pi * s); }, 1,
                                      Eigen::Vector2d(3.4, 1.7));
  return scene;
}

ChainScene family_member(std::uint64_t n) {
  Random random(0x6e756e6f + n);
  ChainScene scene;
  scene.name = fmt::format("family-{:03}", n);
  scene.particles = 32;
  scene.arrival_time = random.uniform(0.4, 2);
  scene.cloth.hinge_stiffness = random.log_uniform(1e-4, 1e-1);
  scene.launch = (n + n / 8) % 2 == 0 ? Launch::inextensible : Launch::ballistic;
  const double turning = random.uniform(0.2, 1.5) * pi;
  scene.initial = random_curve(random, turning, 1, Eigen::Vector2d(0, 1));
  const Eigen::Vector2d center(random.uniform(1, 3), random.uniform(0.5, 2));
  scene.target =
      n % 8 == 7 ? sharp_target(n / 8, center) : random_curve(random, turning, 1, center);
  scene.cloth.stretch_stiffness = 200 * std::pow(10, std::floor(random.uniform(0, 3)));
  return scene;
}

std::vector<ChainScene> family(std::uint64_t count) {
  std::vector<ChainScene> scenes;
  for (std::uint64_t n = 0; n < count; ++n) scenes.push_back(family_member(n));
  return scenes;
}

}  // namespace nuno::scene_library
