#pragma once

#include <nuno/chain_morph.h>
#include <nuno/problem.h>
#include <nuno/sheet_morph.h>

#include <array>
#include <memory>
#include <variant>
#include <vector>

namespace nuno {

/// When on the way a reference correction counts: correction k is added in proportion to
/// (t/t₀)^correction_powers[k], from one that turns the whole flight, and its launch, to one that
/// comes in the last hundredth.
inline constexpr std::array<int, 4> correction_powers = {1, 6, 36, 216};
using CorrectionShares = std::array<double, correction_powers.size()>;

/// The rates at which the corrections come in at t = 0 [1/s].
CorrectionShares correction_rates_at_start(double arrival_time);

/// The shape that control pulls towards, step by step, about its own mass centre.
///
/// `hold` is the paper's: the target from the first step on. `morph` moves from the initial shape
/// to the target, see chain_morph.h and sheet_morph.h, by s from 0 at launch to 1 at arrival:
/// `pass` takes s = t/t₀ and arrives in full swing, `settle` takes s = (t/t₀)·(2 − t/t₀) and
/// arrives with the shape at rest. Reference corrections δₖ of the problem are added to either
/// reference as Σ wₖ·δₖ, w = (t/t₀)^correction_powers (see refine.h).
///
/// A copyable value that is advanced step by step; copies share what does not change.
class ReferenceMotion {
 public:
  ReferenceMotion(const Problem& problem, double time_step);

  const Points& shape() const { return shape_; }  ///< [d × N], m

  /// Mean velocity of the shape over the last step; of the motion itself at t = 0 [d × N], m/s.
  const Points& velocity() const { return velocity_; }

  bool moves() const { return moves_; }

  const CorrectionShares& correction_shares() const { return correction_shares_; }  ///< w

  /// Mean dw/dt over the last step; its own value at t = 0 [1/s].
  const CorrectionShares& correction_rates() const { return correction_rates_; }

  /// Goes on by one time step. Every flight does so at each of its own, so this is where one ends:
  /// throws Stopped once the problem's stop is requested.
  void advance();

 private:
  void place_shape();
  void add_correction(const CorrectionShares& shares, Points& to) const;

  bool moves_;
  double time_step_;
  double step_time_;  ///< of t₀
  double time_ = 0;   ///< t/t₀
  CorrectionShares correction_shares_ = {};
  CorrectionShares correction_rates_ = {};
  Points shape_;
  Points velocity_;
  std::stop_token stop_;
  /// The way without corrections: a shape that is held, or a motion.
  std::variant<std::shared_ptr<const Points>, ChainMorph, SheetMorph> way_;
  std::shared_ptr<const std::vector<Points>> offsets_;  ///< δ about their mass centres, or none
};

}  // namespace nuno
