#include <nuno/conditioning.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace nuno {

bool diverged(const Rollout& rollout) {
  return rollout.status == RolloutStatus::diverged || !rollout.final.allFinite() ||
         !std::isfinite(rollout.error.mean) || !std::isfinite(rollout.error.max) ||
         !std::isfinite(rollout.error.centroid) || !std::isfinite(rollout.control_effort);
}

double bounded_sensitivity(const Backend& backend, const Rollout& flight) {
  return std::min(sensitivity(backend, flight), 1 / backend.smallest_perturbation());
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

}  // namespace nuno
