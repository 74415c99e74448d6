#include "paper_procedure.h"

#include <nuno/launch.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace nuno::bench {
namespace {

struct Vec2 {
  double x = 0, y = 0;
};
Vec2 operator+(Vec2 a, Vec2 b) { return {a.x + b.x, a.y + b.y}; }
Vec2 operator-(Vec2 a, Vec2 b) { return {a.x - b.x, a.y - b.y}; }
Vec2 operator*(double s, Vec2 a) { return {s * a.x, s * a.y}; }
double dot(Vec2 a, Vec2 b) { return a.x * b.x + a.y * b.y; }
double cross(Vec2 a, Vec2 b) { return a.x * b.y - a.y * b.x; }
Vec2 normal(Vec2 a) { return {-a.y, a.x}; }
Vec2 column(const Points& points, std::size_t i) {
  return {points(0, static_cast<Index>(i)), points(1, static_cast<Index>(i))};
}

}  // namespace

PlainChain::PlainChain(const Problem& problem, Index steps, PlainLaunch launch)
    : problem_(problem), steps_(steps), target_shape_(shape_of(problem.target)) {
  const Chain& chain = problem.chain();
  const double h = problem.arrival_time / static_cast<double>(steps);
  const double r = 1 - h * chain.drag_rate;
  launch_velocity_ =
      launch == PlainLaunch::paper
          ? ballistic_launch(chain.initial, problem.target, problem.arrival_time, chain.gravity,
                             chain.drag_rate)
          : ballistic_launch(chain.initial, problem.target, chain.gravity, {h, r, h, r, h}, steps);
  if (problem.launch == Launch::inextensible) {
    launch_velocity_ = without_stretching(chain.initial, launch_velocity_);
  }
}

double PlainChain::error(double gain) const {
  const Chain& chain = problem_.chain();
  const ChainMaterial& cloth = chain.material;
  const double h = problem_.arrival_time / static_cast<double>(steps_);
  const double mass = chain.particle_mass;
  const auto n = static_cast<std::size_t>(chain.particles());
  const double* rest_length = chain.rest_length.data();
  const double* hinge_length = chain.hinge_length.data();

  std::vector<Vec2> x(n), v(n), f(n), target(n);
  std::vector<Vec2> direction(n - 1);
  std::vector<double> length(n - 1), turning(n - 1);
  for (std::size_t i = 0; i < n; ++i) {
    x[i] = column(chain.initial, i);
    v[i] = column(launch_velocity_, i);
    target[i] = column(target_shape_, i);
  }

  for (Index step = 0; step < steps_; ++step) {
    // Gravity, air drag and shape control.
    Vec2 centroid;
    for (std::size_t i = 0; i < n; ++i) centroid = centroid + x[i];
    centroid = (1 / static_cast<double>(n)) * centroid;
    for (std::size_t i = 0; i < n; ++i) {
      f[i] =
          gain * (target[i] - (x[i] - centroid)) - (chain.drag_rate * chain.particle_mass) * v[i];
      f[i].y -= mass * chain.gravity;
    }
    // Stretch springs and dashpots.
    for (std::size_t i = 0; i + 1 < n; ++i) {
      const Vec2 span = x[i + 1] - x[i];
      const Vec2 rate = v[i + 1] - v[i];
      length[i] = std::sqrt(dot(span, span));
      direction[i] = (1 / length[i]) * span;
      const double tension = (cloth.stretch_stiffness * (length[i] - rest_length[i]) +
                              cloth.stretch_damping * dot(direction[i], rate)) /
                             rest_length[i];
      f[i] = f[i] + tension * direction[i];
      f[i + 1] = f[i + 1] - tension * direction[i];
      if (cloth.hinge_damping > 0) turning[i] = cross(direction[i], rate) / length[i];
    }
    // Hinges.
    for (std::size_t i = 0; i + 2 < n; ++i) {
      const Vec2 a = direction[i];
      const Vec2 b = direction[i + 1];
      double moment = cloth.hinge_stiffness * std::atan2(cross(a, b), dot(a, b));
      if (cloth.hinge_damping > 0) moment += cloth.hinge_damping * (turning[i + 1] - turning[i]);
      moment /= hinge_length[i];
      const Vec2 left = (moment / length[i]) * normal(a);
      const Vec2 right = (moment / length[i + 1]) * normal(b);
      f[i] = f[i] - left;
      f[i + 1] = f[i + 1] + left + right;
      f[i + 2] = f[i + 2] - right;
    }
    for (std::size_t i = 0; i < n; ++i) {
      v[i] = v[i] + (h / mass) * f[i];
      x[i] = x[i] + h * v[i];
    }
  }

  double sum = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const Vec2 residual = x[i] - column(problem_.target, i);
    sum += std::sqrt(dot(residual, residual));
  }
  return std::isfinite(sum) ? sum / static_cast<double>(n)
                            : std::numeric_limits<double>::infinity();
}

Index PlainChain::fewest_steps(const Problem& problem) {
  // Stable where h²ω² + 2hc < 4. On a straight chain the stretch springs have ω² = 4·EA/(ℓm),
  // c = 4·ηA/(ℓm), and the hinges, across it, ω² = 16·EI/(ℓ³m), c = 16·ηI/(ℓ³m).
  const Chain& chain = problem.chain();
  const ChainMaterial& cloth = chain.material;
  const double shortest = chain.rest_length.minCoeff();
  const auto stable = [](double squared_frequency, double rate) {
    return 4 / (rate + std::sqrt(rate * rate + 4 * squared_frequency));
  };
  const double along = 4 / (shortest * chain.particle_mass);
  const double across =
      16 / (chain.hinge_length.minCoeff() * shortest * shortest * chain.particle_mass);
  const double h = std::min(stable(along * cloth.stretch_stiffness, along * cloth.stretch_damping),
                            stable(across * cloth.hinge_stiffness, across * cloth.hinge_damping));
  return static_cast<Index>(std::ceil(problem.arrival_time / h));
}

Objective PlainChain::objective() const {
  Objective result;
  result.errors = [this](std::span<const double> gains) {
    std::vector<double> errors;
    for (const double gain : gains) errors.push_back(error(gain));
    return errors;
  };
  result.gain_scale =
      problem_.cloth().particle_mass / (problem_.arrival_time * problem_.arrival_time);
  return result;
}

}  // namespace nuno::bench
