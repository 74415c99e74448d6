#include <nuno/reference_motion.h>

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

AimShares aim_shares_at(double time) {
  static_assert(aim_powers == std::array{1, 6, 36, 216}, "each is six times the one before");
  AimShares shares;
  double share = time;
  for (double& each : shares) {
    each = share;
    const double squared = share * share;
    share = squared * squared * squared;
  }
  return shares;
}

}  // namespace

ReferenceMotion::ReferenceMotion(const Problem& problem, double time_step)
    : moves_(problem.reference == Reference::morph),
      time_step_(time_step),
      step_time_(time_step / problem.arrival_time) {
  const Points& initial = problem.chain.initial;
  for (const Points& offset : problem.aim_offset) offsets_.push_back(shape_of(offset));
  for (std::size_t k = 0; k < aim_powers.size(); ++k) {
    aim_rates_[k] = aim_powers[k] == 1 ? 1 / problem.arrival_time : 0;
  }
  if (!moves_) {
    shape_ = shape_of(problem.target);
    if (!offsets_.empty()) {
      held_ = shape_;
      place_shape();
    }
    velocity_ = Points::Zero(2, shape_.cols());
    add_aim(aim_rates_, velocity_);
    return;
  }
  const Vector from = unwrapped_directions(initial);
  Vector change = unwrapped_directions(problem.target) - from;
  const double mean = change.mean();
  change.array() += std::remainder(mean, 2 * pi) - mean;  // the shorter way on average
  length_ = segment_lengths(initial);
  length_change_ = segment_lengths(problem.target) - length_;
  direction_ = rotations(from);

  // s after n steps of u = h/t₀ each: n·u, or n·u·(2 − n·u). A step adds u·(2 − (2n + 1)·u) there,
  // 2u² less each time.
  const double u = step_time_;
  const bool settles = problem.arrival == Arrival::settle;
  step_progress_ = settles ? u * (2 - u) : u;
  step_change_ = settles ? -2 * u * u : 0;
  turn_ = rotations(step_progress_ * change);
  turn_change_ = rotations(step_change_ * change);

  place_shape();
  // ẋ at t = 0: every segment turns at Δφ·ṡ and grows at Δl·ṡ.
  const double rate = (settles ? 2 : 1) / problem.arrival_time;
  velocity_ = Points::Zero(shape_.rows(), shape_.cols());
  for (Index i = 0; i < length_.size(); ++i) {
    const Eigen::Vector2d along = direction_.col(i);
    const Eigen::Vector2d across(-along.y(), along.x());
    velocity_.col(i + 1) =
        velocity_.col(i) + rate * (length_change_[i] * along + change[i] * length_[i] * across);
  }
  velocity_ = shape_of(velocity_);
  add_aim(aim_rates_, velocity_);
}

void ReferenceMotion::advance() {
  time_ += step_time_;
  const AimShares shares = aim_shares_at(time_);
  for (std::size_t k = 0; k < shares.size(); ++k) {
    aim_rates_[k] = (shares[k] - aim_shares_[k]) / time_step_;
  }
  aim_shares_ = shares;
  if (!moves_ && offsets_.empty()) return;

  const Points before = shape_;
  if (moves_) {
    progress_ += step_progress_;
    step_progress_ += step_change_;
    turn(direction_, turn_);
    turn(turn_, turn_change_);
  }
  place_shape();
  velocity_ = (shape_ - before) / time_step_;
}

void ReferenceMotion::place_shape() {
  if (moves_) {
    shape_.resize(2, length_.size() + 1);
    shape_.col(0).setZero();
    for (Index i = 0; i < length_.size(); ++i) {
      shape_.col(i + 1) =
          shape_.col(i) + (length_[i] + progress_ * length_change_[i]) * direction_.col(i);
    }
    shape_ = shape_of(shape_);
  } else {
    shape_ = held_;
  }
  add_aim(aim_shares_, shape_);
}

void ReferenceMotion::add_aim(const AimShares& shares, Points& to) const {
  for (std::size_t k = 0; k < offsets_.size(); ++k) to += shares[k] * offsets_[k];
}

}  // namespace nuno
