#pragma once

#include <nuno/backend.h>
#include <nuno/error.h>

#include <optional>
#include <string>
#include <vector>

namespace nuno {

struct RolloutOptions {
  /// Frames kept per second of flight [1/s], the first at t = 0 and one at t₀; 0 keeps none.
  double frames_per_second = 0;
  /// Flight after arrival, without control, whose frames are kept as well [s].
  double tail = 0;
  /// Whether the control forces in these frames are kept.
  bool keeps_forces = false;
};

enum class RolloutStatus { ok, diverged };

/// One flight, and how it arrived.
struct Rollout {
  RolloutStatus status = RolloutStatus::ok;
  Gains gains = 0;            ///< α of every group [N/m]
  Points launch_velocity;     ///< [d × N], m/s
  Points final;               ///< positions at arrival [d × N], m
  Points final_velocity;      ///< mean over the last step before it [d × N], m/s
  ArrivalError error;         ///< infinite where the rollout diverged
  double control_effort = 0;  ///< rms over particles and time of control force / particle weight
  double max_strain = 0;      ///< largest |l/ℓ − 1| of an edge on the way
  /// Largest motion of an edge's ends against each other in one step, over ℓ: its turn [rad] where
  /// that is small and nothing stretches.
  double max_turn = 0;
  /// Sum of the steps' local truncation errors (Verlet's), h²/12 times the change of the
  /// acceleration, root mean square over the particles, over L [1].
  double truncation_error = 0;
  std::optional<double> step_error;     ///< where it was measured, see conditioning.h [1]
  std::optional<double> finer_strain;   ///< max_strain with half of the step, measured beside it
  std::vector<double> frame_times;      ///< [s]
  std::vector<Points> frame_positions;  ///< [d × N] each, m
  /// Of the step that ends at the frame or after it, of the first frame's the first one's; 0 after
  /// arrival [d × N] each, N. Where they are kept.
  std::vector<Points> frame_forces;
  Index diverged_at_step = 0;  ///< the first step with a bad value
  std::string reason;          ///< why it diverged, for people
};

/// Launch, then {shape control, step} until arrival, under gains ≥ 0 [N/m]; 0 is launch only.
Rollout rollout(const Backend& backend, const Gains& gains, const RolloutOptions& options = {});

/// The same launch from other positions [d × N], m.
Rollout rollout(const Backend& backend, const Gains& gains, const RolloutOptions& options,
                const Points& initial);

/// The initial positions moved a little, by a pattern that has all wavelengths: by `size`·L on
/// average, and the mass centre stays. A chain turns its segments, which keep their lengths; a
/// sheet moves along its normals, so that a flat one keeps those of its edges to first order.
/// Different `seed`s give different patterns.
Points perturbed(const Problem& problem, double size, unsigned seed = 0);

/// How much a small perturbation at the start has grown by arrival: mean displacement at the end
/// over mean displacement at the start, of `flight` against a twin from perturbed positions. A
/// flight above 10 is fragile: engines, steps and machines need not agree on it. Saturates where
/// the twins have nothing in common any more. The perturbation is the backend's smallest, or a
/// thousand last digits of the farthest coordinate.
double sensitivity(const Backend& backend, const Rollout& flight);

/// Whether these positions [d × N] are no cloth any more: an edge of a thousand times its length,
/// or not finite. A rollout that gets there has diverged.
bool is_torn(const Cloth& cloth, const Points& positions);

/// The force that control effort is measured in [N]: the weight m̄·g of a particle of mean mass, or
/// m̄·L/t₀² without gravity. A force on a particle counts as its m̄/mᵢ.
double effort_unit(const Problem& problem);

}  // namespace nuno
