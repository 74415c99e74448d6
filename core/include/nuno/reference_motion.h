#pragma once

#include <nuno/problem.h>

namespace nuno {

/// The shape that control pulls towards, step by step, about its own centroid.
///
/// `hold` is the paper's: the target from the first step on. `morph` moves from the initial shape
/// to the target by turning each segment from its first direction to its last (unwrapped along the
/// chain, the shorter way on average) and changing its length in proportion, so that a cloth can
/// follow it without stretching when the two lengths agree: with s from 0 at launch to 1 at
/// arrival,
///     φᵢ(s) = φᵢ(0) + s·Δφᵢ,   lᵢ(s) = lᵢ(0) + s·Δlᵢ.
/// `pass` takes s = t/t₀ and arrives in full swing, `settle` takes s = (t/t₀)·(2 − t/t₀) and
/// arrives with the shape at rest. An aim offset δ of the problem is added as w·δ with w = s¹⁶,
/// late on the way (`hold` has w = 1 throughout).
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

  double aim_share() const { return aim_share_; }  ///< w

  /// Mean dw/dt over the last step [1/s].
  double aim_rate() const { return aim_rate_; }

  /// Goes on by one time step.
  void advance();

 private:
  void place_shape();

  bool moves_;
  double time_step_;
  double progress_ = 0;   ///< s
  double aim_share_ = 0;  ///< w
  double aim_rate_ = 0;
  double step_progress_ = 0;  ///< s of the next step less s of this one
  double step_change_ = 0;    ///< what a step adds to step_progress_
  Points shape_;
  Points velocity_;
  Vector length_;         ///< of the segments at s = 0 [N − 1]
  Vector length_change_;  ///< until s = 1
  Points direction_;      ///< unit vectors [2 × N − 1], as are the rotations (cosine, sine):
  Points offset_;         ///< δ about its centroid, or empty
  Points turn_;           ///< of the next step
  Points turn_change_;    ///< what a step turns turn_ by
};

}  // namespace nuno
