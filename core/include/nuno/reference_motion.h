#pragma once

#include <nuno/problem.h>

#include <array>

namespace nuno {

/// When on the way an aim offset counts: offset k is added in proportion to (t/t₀)^aim_powers[k],
/// from one that turns the whole flight, and its launch, to one that comes in the last hundredth.
inline constexpr std::array<int, 4> aim_powers = {1, 6, 36, 216};
using AimShares = std::array<double, aim_powers.size()>;

/// The shape that control pulls towards, step by step, about its own centroid.
///
/// `hold` is the paper's: the target from the first step on. `morph` moves from the initial shape
/// to the target by turning each segment from its first direction to its last (unwrapped along the
/// chain, the shorter way on average) and changing its length in proportion, so that a cloth can
/// follow it without stretching when the two lengths agree: with s from 0 at launch to 1 at
/// arrival,
///     φᵢ(s) = φᵢ(0) + s·Δφᵢ,   lᵢ(s) = lᵢ(0) + s·Δlᵢ.
/// `pass` takes s = t/t₀ and arrives in full swing, `settle` takes s = (t/t₀)·(2 − t/t₀) and
/// arrives with the shape at rest. Aim offsets δₖ of the problem are added to either reference as
/// Σ wₖ·δₖ, w = (t/t₀)^aim_powers (see refine.h).
///
/// A copyable value that is advanced step by step; a step costs a few multiplications a segment,
/// because the directions turn by rotations that themselves turn by a constant rotation.
class ReferenceMotion {
 public:
  ReferenceMotion(const Problem& problem, double time_step);

  const Points& shape() const { return shape_; }  ///< [2 × N], m

  /// Mean velocity of the shape over the last step; of the motion itself at t = 0 [2 × N], m/s.
  const Points& velocity() const { return velocity_; }

  bool moves() const { return moves_; }

  const AimShares& aim_shares() const { return aim_shares_; }  ///< w

  /// Mean dw/dt over the last step; its own value at t = 0 [1/s].
  const AimShares& aim_rates() const { return aim_rates_; }

  /// Goes on by one time step.
  void advance();

 private:
  void place_shape();
  void add_aim(const AimShares& shares, Points& to) const;

  bool moves_;
  double time_step_;
  double step_time_;          ///< of t₀
  double time_ = 0;           ///< t/t₀
  double progress_ = 0;       ///< s
  double step_progress_ = 0;  ///< s of the next step less s of this one
  double step_change_ = 0;    ///< what a step adds to step_progress_
  AimShares aim_shares_ = {};
  AimShares aim_rates_ = {};
  Points shape_;
  Points velocity_;
  Points held_;           ///< the target's shape, if it holds and is aimed off
  Vector length_;         ///< of the segments at s = 0 [N − 1]
  Vector length_change_;  ///< until s = 1
  Points direction_;      ///< unit vectors [2 × N − 1], as are the rotations (cosine, sine):
  Points turn_;           ///< of the next step
  Points turn_change_;    ///< what a step turns turn_ by
  std::vector<Points> offsets_;  ///< δ about their centroids, or empty
};

}  // namespace nuno
