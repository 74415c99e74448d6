#include "scene_library.h"

#include <fmt/format.h>

#include <array>
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

Points curve_from_direction(double (*direction)(double s), double length, const Vector& center) {
  return integrate(direction, length, center);
}

Scene straight_to_s() {
  Scene scene;
  scene.name = "straight-to-s";
  scene.arrival_time = 1;
  scene.initial.resize(2, 2);
  scene.initial << 0, 1, 1, 1;
  scene.target = curve_from_direction([](double s) { return 1.2 * std::sin(2 * pi * s); }, 1,
                                      Eigen::Vector2d(3.4, 1.7));
  return scene;
}

Scene family_member(std::uint64_t n) {
  Random random(0x6e756e6f + n);
  Scene scene;
  scene.name = fmt::format("family-{:03}", n);
  scene.particles = 32;
  scene.arrival_time = random.uniform(0.4, 2);
  scene.cloth.hinge_stiffness = random.log_uniform(1e-4, 1e-1);
  scene.launch = n % 2 == 0 ? Launch::inextensible : Launch::ballistic;
  const double turning = random.uniform(0.2, 1.5) * pi;
  scene.initial = random_curve(random, turning, 1, Eigen::Vector2d(0, 1));
  const Eigen::Vector2d center(random.uniform(1, 3), random.uniform(0.5, 2));
  scene.target =
      n % 8 == 7 ? sharp_target(n / 8, center) : random_curve(random, turning, 1, center);
  return scene;
}

std::vector<Scene> family(std::uint64_t count) {
  std::vector<Scene> scenes;
  for (std::uint64_t n = 0; n < count; ++n) scenes.push_back(family_member(n));
  return scenes;
}

}  // namespace nuno::scene_library
