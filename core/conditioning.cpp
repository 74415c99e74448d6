#include <nuno/conditioning.h>

#include <nuno/error.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

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
  const std::string growth =
      sensitivity < 1e6 ? fmt::format("{:.0f}", sensitivity) : fmt::format("{:.1g}", sensitivity);
  return fmt::format(
      "fragile: a change at the start grows {}-fold; engines and steps need not agree", growth);
}

bool has_doubtful_step(const Rollout& flight, double sensitivity) {
  // Of 2 100 calm flights at default steps, with step errors from 1e-7 to 0.1 on two engines, none
  // is coarse below a quarter, and seven are below the whole. What is fragile has its word already.
  const double growth = std::clamp(sensitivity, 1.0, largest_calm_sensitivity);
  if (!(growth * flight.truncation_error <= largest_step_error / 4)) return true;
  // An edge that turns by φ in a step is stretched by some φ²/4, at most 2φ², for the step's sake:
  // more than half of the strain, which deserves a word, only where that is below 4φ².
  const double squared_turn = flight.max_turn * flight.max_turn;
  const bool may_be_of_turning =
      flight.max_strain > largest_calm_strain && flight.max_strain < 4 * squared_turn;
  constexpr double wild_strain = 0.1;
  return may_be_of_turning || flight.max_strain > wild_strain;
}

void measure_step(const Cloth& cloth, const Rollout& finer, Rollout& flight) {
  flight.step_error = flight.finer_strain = std::numeric_limits<double>::infinity();
  if (diverged(finer)) return;
  flight.step_error = shape_difference(cloth, flight.final, finer.final).mean / cloth.size;
  flight.finer_strain = finer.max_strain;
}

std::string coarseness(const Rollout& flight, double time_step) {
  if (!flight.step_error || !flight.finer_strain) return {};
  // Second order: half of the step leaves a quarter of the error. A large one is not in proportion
  // yet, and says no more than that the step is too long.
  constexpr double in_proportion = 0.1;
  if (const double error = *flight.step_error; error > largest_step_error) {
    const double halvings = std::max(
        1.0, std::ceil(std::log2(std::min(error, in_proportion) / largest_step_error) / 2));
    return fmt::format(
        "coarse: half of the step moves the end shape by {:.2g} % of L; a time step of {:.2g} s "
        "{}",
        100 * error, time_step / std::exp2(halvings),
        error > in_proportion ? "or less is worth a try" : "resolves it");
  }
  // Segments that turn by much in a step are stretched by it, wherever they end. It is of second
  // order: where the strain is t + 4e, half of the step leaves t + e. Told where 4e is over half.
  const double own = 4.0 / 3 * (flight.max_strain - *flight.finer_strain);
  if (flight.max_strain > largest_calm_strain && own > 0.5 * flight.max_strain) {
    return fmt::format(
        "coarse on the way: half of the step strains it by {:.2g} % only; a time step of {:.2g} s "
        "resolves more",
        100 * *flight.finer_strain, time_step / 2);
  }
  return {};
}

std::string caution(const Rollout& flight, double sensitivity, double time_step) {
  const std::string fragile = fragility(sensitivity);
  return fragile.empty() ? coarseness(flight, time_step) : fragile;
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
