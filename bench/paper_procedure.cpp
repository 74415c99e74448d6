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

/// The chain's particles on their way.
class Flight {
 public:
  Flight(const Problem& problem, const Points& launch_velocity, const Points& target_shape)
      : chain_(problem.chain()), n_(static_cast<std::size_t>(chain_.particles())) {
    for (std::size_t i = 0; i < n_; ++i) {
      x_[i] = column(chain_.initial, i);
      v_[i] = column(launch_velocity, i);
      target_[i] = column(target_shape, i);
    }
  }

  /// Gravity, air drag and shape control.
  void pull(double gain) {
    Vec2 centroid;
    for (std::size_t i = 0; i < n_; ++i) centroid = centroid + x_[i];
    centroid = (1 / static_cast<double>(n_)) * centroid;
    const double drag = chain_.drag_rate * chain_.particle_mass;
    for (std::size_t i = 0; i < n_; ++i) {
      f_[i] = gain * (target_[i] - (x_[i] - centroid)) - drag * v_[i];
      f_[i].y -= chain_.particle_mass * chain_.gravity;
    }
  }

  /// Stretch springs and dashpots.
  void stretch() {
    for (std::size_t i = 0; i + 1 < n_; ++i) {
      const Vec2 span = x_[i + 1] - x_[i];
      const Vec2 rate = v_[i + 1] - v_[i];
      length_[i] = std::sqrt(dot(span, span));
      direction_[i] = (1 / length_[i]) * span;
      const double tension = (cloth_.stretch_stiffness * (length_[i] - rest_length_[i]) +
                              cloth_.stretch_damping * dot(direction_[i], rate)) /
                             rest_length_[i];
      f_[i] = f_[i] + tension * direction_[i];
      f_[i + 1] = f_[i + 1] - tension * direction_[i];
      if (cloth_.hinge_damping > 0) turning_[i] = cross(direction_[i], rate) / length_[i];
    }
  }

  /// Hinges; after `stretch`, which measures the segments.
  void bend() {
    for (std::size_t i = 0; i + 2 < n_; ++i) {
      const Vec2 a = direction_[i];
      const Vec2 b = direction_[i + 1];
      double moment = cloth_.hinge_stiffness * std::atan2(cross(a, b), dot(a, b));
      if (cloth_.hinge_damping > 0) {
        moment += cloth_.hinge_damping * (turning_[i + 1] - turning_[i]);
      }
      moment /= hinge_length_[i];
      const Vec2 left = (moment / length_[i]) * normal(a);
      const Vec2 right = (moment / length_[i + 1]) * normal(b);
      f_[i] = f_[i] - left;
      f_[i + 1] = f_[i + 1] + left + right;
      f_[i + 2] = f_[i + 2] - right;
    }
  }

  void move(double h) {
    for (std::size_t i = 0; i < n_; ++i) {
      v_[i] = v_[i] + (h / chain_.particle_mass) * f_[i];
      x_[i] = x_[i] + h * v_[i];
    }
  }

  double error(const Points& target) const {
    double sum = 0;
    for (std::size_t i = 0; i < n_; ++i) {
      const Vec2 residual = x_[i] - column(target, i);
      sum += std::sqrt(dot(residual, residual));
    }
    return std::isfinite(sum) ? sum / static_cast<double>(n_)
                              : std::numeric_limits<double>::infinity();
  }

 private:
  const Chain& chain_;
  const ChainMaterial& cloth_ = chain_.material;
  const double* rest_length_ = chain_.rest_length.data();
  const double* hinge_length_ = chain_.hinge_length.data();
  std::size_t n_;
  std::vector<Vec2> x_ = std::vector<Vec2>(n_), v_ = x_, f_ = x_, target_ = x_, direction_ = x_;
  std::vector<double> length_ = std::vector<double>(n_), turning_ = length_;
};

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
  Flight flight(problem_, launch_velocity_, target_shape_);
  const double h = problem_.arrival_time / static_cast<double>(steps_);
  for (Index step = 0; step < steps_; ++step) {
    flight.pull(gain);
    flight.stretch();
    flight.bend();
    flight.move(h);
  }
  return flight.error(problem_.target);
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
