#pragma once

#include <nuno/problem.h>

namespace nuno {

/// A chain's motion from its initial shape to the target: each segment turns from its first
/// direction to its last (unwrapped along the chain, the shorter way on average) and changes its
/// length in proportion, so that a cloth can follow it without stretching when the two lengths
/// agree: with s from 0 to 1,
///     φᵢ(s) = φᵢ(0) + s·Δφᵢ,   lᵢ(s) = lᵢ(0) + s·Δlᵢ.
///
/// A copyable value; a step costs a few multiplications a segment, because the directions turn by
/// rotations that themselves turn by a constant rotation.
class ChainMorph {
 public:
  /// Of a problem with a chain; `step_time` is a step's share of t₀.
  ChainMorph(const Problem& problem, double step_time);

  Points shape() const;              ///< about its centroid [2 × N], m
  Points velocity_at_start() const;  ///< of the motion itself at t = 0 [2 × N], m/s

  /// Goes on by one time step.
  void advance();

 private:
  double progress_ = 0;       ///< s
  double step_progress_ = 0;  ///< s of the next step less s of this one
  double step_change_ = 0;    ///< what a step adds to step_progress_
  double start_rate_ = 0;     ///< ds/dt at t = 0 [1/s]
  Vector length_;             ///< of the segments at s = 0 [N − 1]
  Vector length_change_;      ///< until s = 1
  Vector direction_change_;   ///< Δφ
  Points direction_;          ///< unit vectors [2 × N − 1], as are the rotations (cosine, sine):
  Points turn_;               ///< of the next step
  Points turn_change_;        ///< what a step turns turn_ by
};

}  // namespace nuno
