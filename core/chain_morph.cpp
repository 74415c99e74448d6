#include <nuno/chain_morph.h>

#include <cmath>
#include <numbers>

namespace nuno {
namespace {

using std::numbers::pi;

/// Directions of the segments, unwrapped along the chain [N − 1], rad.
Vector unwrapped_directions(const Points& points) {
  Vector directions(points.cols() - 1);
  for (Index i = 0; i < directions.size(); ++i) {
    const Eigen::Vector2d span = points.col(i + 1) - points.col(i);
    const double direction = std::atan2(span.y(), span.x());
    directions[i] = i == 0
                        ? direction
                        : directions[i - 1] + std::remainder(direction - directions[i - 1], 2 * pi);
  }
  return directions;
}

/// Unit vectors (cos, sin) of angles.
Points rotations(const Vector& angles) {
  Points result(2, angles.size());
  result.row(0) = angles.array().cos();
  result.row(1) = angles.array().sin();
  return result;
}

/// Turns each column of `vectors` by the rotation (cos, sin) in the same column.
void turn(Points& vectors, const Points& rotation) {
  for (Index i = 0; i < vectors.cols(); ++i) {
    const Eigen::Vector2d v = vectors.col(i);
    vectors(0, i) = v.x() * rotation(0, i) - v.y() * rotation(1, i);
    vectors(1, i) = v.x() * rotation(1, i) + v.y() * rotation(0, i);
  }
}

}  // namespace

ChainMorph::ChainMorph(const Problem& problem, double step_time) {
  const Points& initial = problem.cloth().initial;
  const Vector from = unwrapped_directions(initial);
  direction_change_ = unwrapped_directions(problem.target) - from;
  const double mean = direction_change_.mean();
  direction_change_.array() += std::remainder(mean, 2 * pi) - mean;  // the shorter way on average
  length_ = segment_lengths(initial);
  length_change_ = segment_lengths(problem.target) - length_;
  direction_ = rotations(from);

  // s after n steps of u = h/t₀ each: n·u, or n·u·(2 − n·u). A step adds u·(2 − (2n + 1)·u) there,
  // 2u² less each time.
  const double u = step_time;
  const bool settles = problem.arrival == Arrival::settle;
  step_progress_ = settles ? u * (2 - u) : u;
  step_change_ = settles ? -2 * u * u : 0;
  turn_ = rotations(step_progress_ * direction_change_);
  turn_change_ = rotations(step_change_ * direction_change_);
  start_rate_ = (settles ? 2 : 1) / problem.arrival_time;
}

// ẋ at t = 0: every segment turns at Δφ·ṡ and grows at Δl·ṡ. Before the first step.
Points ChainMorph::velocity_at_start() const {
  Points velocity = Points::Zero(2, length_.size() + 1);
  for (Index i = 0; i < length_.size(); ++i) {
    const Eigen::Vector2d along = direction_.col(i);
    const Eigen::Vector2d across(-along.y(), along.x());
    velocity.col(i + 1) =
        velocity.col(i) +
        start_rate_ * (length_change_[i] * along + direction_change_[i] * length_[i] * across);
  }
  return shape_of(velocity);
}

void ChainMorph::advance() {
  progress_ += step_progress_;
  step_progress_ += step_change_;
  turn(direction_, turn_);
  turn(turn_, turn_change_);
}

Points ChainMorph::shape() const {
  Points shape(2, length_.size() + 1);
  shape.col(0).setZero();
  for (Index i = 0; i < length_.size(); ++i) {
    shape.col(i + 1) =
        shape.col(i) + (length_[i] + progress_ * length_change_[i]) * direction_.col(i);
  }
  return shape_of(shape);
}

}  // namespace nuno
