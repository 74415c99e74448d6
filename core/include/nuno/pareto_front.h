#pragma once

#include <nuno/optimize.h>
#include <nuno/rollout.h>

#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace nuno {

/// What a gain buys and what it costs.
struct ParetoPoint {
  double gain = 0;    ///< α [N/m]
  double error = 0;   ///< E(α) [m]
  double effort = 0;  ///< control effort, see Rollout
};

/// Those of some points that no other beats in both error and effort: ascending in effort,
/// descending in error. Points without a finite error (rollouts that diverged) are left out.
std::vector<ParetoPoint> pareto_optimal(std::vector<ParetoPoint> points);

/// The Pareto front of a backend's problem: among launch only, gains that are log-spaced over the
/// objective's range, `count` ≥ 2 of them, and of those that a search has `tried` the nearest, and
/// each that comes at least 1 % nearer than all smaller ones: its valleys may lie between.
/// `before_rollout` is called before every rollout, by several threads at once; what it throws ends
/// the work and comes out of here.
std::vector<ParetoPoint> pareto_front(const Backend& backend, Index count = 64,
                                      std::span<const Evaluation> tried = {},
                                      const std::function<void()>& before_rollout = {});

/// The point of least effort whose error is at most `error_limit` [m], between the points of
/// `curve` too; nothing if no point is as near. `before_rollout` as in pareto_front.
std::optional<ParetoPoint> least_effort(const Backend& backend,
                                        const std::vector<ParetoPoint>& curve, double error_limit,
                                        const std::function<void()>& before_rollout = {});

/// The point of least error whose effort is at most `effort_limit`, between the points of `curve`
/// too. `before_rollout` as in pareto_front.
ParetoPoint least_error(const Backend& backend, const std::vector<ParetoPoint>& curve,
                        double effort_limit, const std::function<void()>& before_rollout = {});

}  // namespace nuno
