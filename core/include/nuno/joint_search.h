#pragma once

#include <nuno/optimize.h>

#include <functional>
#include <string>
#include <vector>

namespace nuno {

/// E as a function of the gains of several groups: many gains in, as many groups in each, and their
/// errors out.
struct JointObjective {
  /// E under each [m]; +∞ where a rollout diverged.
  std::function<std::vector<double>(std::span<const Gains> gains)> errors;
  /// E and its derivatives, see Objective.
  std::function<std::vector<ErrorSample>(std::span<const Gains> gains)> samples;
  double gain_scale = 1;                                          ///< see Objective [N/m]
  double largest_gain = std::numeric_limits<double>::infinity();  ///< of any group [N/m]
  double negligible = 0;                                          ///< see Objective [m]
};

/// The error at arrival of a backend's problem; the backend must outlive it.
JointObjective joint_objective(const Backend& backend);

struct JointSearchOptions {
  Index groups = 2;               ///< 1 … most_groups, and no more than the particles' modes fill
  double smallest_gain = 1e-3;    ///< of a group, in gain scales, > 0
  Index scan = 16;                ///< gains tried for either part of a group that is split, ≥ 2
  Index valleys = 4;              ///< of the scan that are descended, the deepest first, ≥ 0
  Index rounds = 60;              ///< of a descent at most, ≥ 1
  double error_tolerance = 1e-6;  ///< relative; a round that gains less is the last
};

/// The best gains for a number of groups.
struct JointStage {
  Gains gains;       ///< of so many groups, or of fewer where another gain buys nothing
  double error = 0;  ///< [m]
};

struct JointSearchSummary {
  OptimizeStatus status = OptimizeStatus::converged;  ///< budget: a descent ran out of rounds
  std::vector<JointStage> stages;  ///< for 1, 2 … groups; the first is where it started
  Index evaluations = 0;           ///< rollouts; a gradient counts as one for every group
  double seconds = 0;              ///< wall clock
  std::string reason;              ///< why it stopped, for people
};

/// Searches the gains of all groups together, one group more at a time: from the best gains of so
/// many groups, the last group is split, either part's gain is scanned, and quasi-Newton descents
/// (BFGS in log α, kept within bounds) go down from the split itself and from the deepest valleys
/// of the scan. So no stage is worse than the one before, and the first is `start`, the best single
/// gain.
JointSearchSummary joint_search(const JointObjective& objective, const Evaluation& start,
                                const JointSearchOptions& options = {});

}  // namespace nuno
