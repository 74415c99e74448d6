#pragma once

#include <nuno/backend.h>

#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace nuno {

/// E(α) as an optimiser sees it: no engine, only many gains in and their errors out.
struct Objective {
  /// E at each gain [m]; +∞ where a rollout diverged.
  std::function<std::vector<double>(std::span<const double> gains)> errors;
  /// E, the arrivals and their derivatives, one derivative each; empty for an engine that knows
  /// none.
  std::function<std::vector<ErrorSample>(std::span<const double> gains)> samples;
  /// m/t₀² [N/m]: the gain whose oscillation turns by one radian until arrival.
  double gain_scale = 1;
  /// Gains above are not resolved by the engine's time step [N/m].
  double largest_gain = std::numeric_limits<double>::infinity();
  /// ζ of the control: E(α) swings with the phase φ = √(α/gain_scale), by e^(−ζφ).
  double damping_ratio = 1;
  double size = 1;  ///< L [m]
  /// An error that is as good as none [m], ≥ 0: below, the smallest gain is the best.
  double negligible = 0;
};

/// The error at arrival of a backend's problem; the backend must outlive it.
Objective objective(const Backend& backend);

/// The gains from 0 on at which E(α) can be followed.
struct GainRange {
  double calm = 0;        ///< up to here [N/m]
  double largest = 0;     ///< ≥ calm [N/m]; between, noise begins
  std::string why;        ///< why it ends there and what takes it farther, for people
  Index evaluations = 0;  ///< that it took to find out
};

/// Up to `largest` [gain scales], but no farther than the engine's time step resolves. A control of
/// ζ < ½ pulls the cloth through itself again and again: from 100 gain scales on, eight gains are
/// tried, and where a radian more of phase moves the arrival by more than the cloth's size, E is
/// noise.
GainRange gain_range(const Objective& objective, double largest = 1e5);

struct Evaluation {
  double gain = 0;   ///< α [N/m]
  double error = 0;  ///< E(α) [m]
};

enum class OptimizeStatus {
  converged,
  budget  ///< the evaluations ran out; the best found is still given
};

/// What an optimiser found and how.
struct OptimizeSummary {
  OptimizeStatus status = OptimizeStatus::converged;
  double gain = 0;
  double error = 0;                 ///< +∞ if every rollout diverged
  Index evaluations = 0;            ///< rollouts, those for derivatives too
  double seconds = 0;               ///< wall clock
  std::vector<Evaluation> history;  ///< descent: the path; global: every gain, ascending
  bool at_largest_gain = false;     ///< the best may lie beyond what the objective allows
  std::string reason;               ///< why it stopped, for people
};

struct SteepestDescentOptions {
  double first_gain = 0;         ///< where it starts [N/m], ≥ 0
  double first_step = 1;         ///< length of the first move, in gain scales, > 0
  double difference = 1e-3;      ///< δ of (E(α+δ) − E(α−δ))/2δ, in α + gain scale, > 0
  double gain_tolerance = 1e-4;  ///< stops when a move is shorter, in α + gain scale, > 0
  Index largest_evaluations = 400;  ///< > 0
};

/// The paper's optimiser (§ 3.2.3): α ← α − λ·dE/dα with the derivative from repeated rollouts and
/// a λ that backtracks until the error falls, so it never ascends; α stays ≥ 0. It stops in the
/// first valley that it meets.
OptimizeSummary steepest_descent(const Objective& objective,
                                 const SteepestDescentOptions& options = {});

struct GlobalSearchOptions {
  double smallest_gain = 1e-2;  ///< of the scan, in gain scales, > 0
  double largest_gain = 1e5;    ///< of the scan, in gain scales; cut to the objective's range
  /// Gains of the scan, 0 among them, ≥ 4; thrice as many by values. Where control is not damped,
  /// they end at 100 gain scales (with derivatives, 10 of them do) and others follow: by values
  /// half a radian of phase apart, with derivatives two, and gaps that no cubic sees through are
  /// halved.
  Index scan = 24;
  Index brackets = 8;  ///< split in a batch, ≥ 1 (by values: valleys in all)
  Index rounds = 12;   ///< at most, ≥ 1, those that halve gaps too; by values, a rollout each
  double gain_tolerance = 1e-6;   ///< of √α, relative; a bracket so narrow is done
  double error_tolerance = 1e-6;  ///< relative; done when no bracket predicts so much less
  /// The best gain of a scene that differs little [N/m]: with derivatives, its valley is searched,
  /// and the whole range only if it has moved far.
  std::optional<double> warm_start = {};
};

/// A scan, then a refinement of the deepest valleys: where the objective knows its derivatives, on
/// cubics through the arrivals of all particles, all valleys in a round; otherwise by
/// Brent's method in one valley after another. Never worse than any gain that it has tried; a
/// valley narrower than the scan, as fragile flights have, may stay unseen.
OptimizeSummary global_search(const Objective& objective, const GlobalSearchOptions& options = {});

}  // namespace nuno
