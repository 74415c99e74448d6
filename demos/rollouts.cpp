#include "rollouts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>

#include "output.h"

namespace nuno {

bool diverged(const Rollout& rollout) {
  return rollout.status == RolloutStatus::diverged || !rollout.final.allFinite() ||
         !std::isfinite(rollout.error.mean) || !std::isfinite(rollout.error.max) ||
         !std::isfinite(rollout.error.centroid) || !std::isfinite(rollout.control_effort);
}

double bounded_sensitivity(const Backend& backend, const Rollout& flight) {
  return std::min(sensitivity(backend, flight), 1 / backend.smallest_disturbance());
}

std::string fragility(double sensitivity) {
  if (!(sensitivity > largest_calm_sensitivity)) return {};
  return fmt::format(
      "fragile: a change at the start grows {:.3g}-fold; engines and steps need not agree",
      sensitivity);
}

std::string divergence_message(const std::string& scene_path, const Backend& backend,
                               const Rollout& rollout) {
  const bool stopped = rollout.status == RolloutStatus::diverged;
  return fmt::format("{}: diverged on {} at α = {} N/m in step {} of {}: {}", scene_path,
                     backend.name(), fmt::join(rollout.gains.groups(), ", "),
                     stopped ? rollout.diverged_at_step : backend.steps(), backend.steps(),
                     stopped ? rollout.reason : "the error is no longer finite");
}

void report_divergence(const std::string& scene_path, const Backend& backend,
                       const Rollout& rollout) {
  complain(divergence_message(scene_path, backend, rollout));
}

namespace {

/// The function `of` many gains at once, if there is one, which counts them for a person.
template <typename Answers, typename Gain>
void count_rollouts(std::function<Answers(std::span<const Gain>)>& of,
                    const std::shared_ptr<std::size_t>& count, const std::string& label) {
  if (!of) return;
  of = [count, label, of](std::span<const Gain> gains) {
    *count += gains.size();
    show_progress(fmt::format("{}: {} rollouts", label, *count));
    return of(gains);
  };
}

}  // namespace

Objective with_progress(Objective objective, const std::string& label) {
  const auto count = std::make_shared<std::size_t>(0);
  count_rollouts(objective.errors, count, label);
  count_rollouts(objective.samples, count, label);
  return objective;
}

JointObjective with_progress(JointObjective objective, const std::string& label) {
  const auto count = std::make_shared<std::size_t>(0);
  count_rollouts(objective.errors, count, label);
  count_rollouts(objective.samples, count, label);
  return objective;
}

}  // namespace nuno
