#pragma once

#include <nuno/rollout.h>

#include <string>

namespace nuno {

/// A perturbation of the start that grows more than this has a fragile answer.
inline constexpr double largest_calm_sensitivity = 10;

/// A cloth that stretches more than this is not the inextensible one that rods stand for.
inline constexpr double largest_calm_strain = 0.005;

/// A flight whose end shape moves more than this with half of the step, over L, is not resolved.
inline constexpr double largest_step_error = 1e-3;

/// Whether a rollout has no answer to show: it diverged, or it grew so far that its error is no
/// number.
bool diverged(const Rollout& rollout);

/// What `sensitivity` says of a flight that has arrived, as a number that a file can hold: at most
/// the growth at which the twins have nothing in common.
double bounded_sensitivity(const Backend& backend, const Rollout& flight);

/// The words for a sensitivity above 10; empty for a calm flight.
std::string fragility(double sensitivity);

/// Whether a flight may deserve a word of coarseness, so that its step is worth measuring: its
/// truncation error, grown as a perturbation of the start does (once to ten times), is more than a
/// quarter of what such a word is for; or it strains, by no more than turning edges do in such
/// steps or by a tenth.
bool has_doubtful_step(const Rollout& flight, double sensitivity);

/// Measures a flight's step against `finer`, the same flight at half of it. Its step_error is how
/// far the end shapes are apart: mean distance with the mass centres aligned, over L. Both numbers
/// are +∞ where that one diverged.
void measure_step(const Cloth& cloth, const Rollout& finer, Rollout& flight);

/// The words for a flight in such steps [s] whose end shape, or whose strain on the way, is the
/// step's own, and the step to take instead; empty for one that is resolved, or not measured.
std::string coarseness(const Rollout& flight, double time_step);

/// The word of warning for a judged flight in such steps: fragile, or else coarse; empty where it
/// can be trusted. A fragile flight is another one at any step.
std::string caution(const Rollout& flight, double sensitivity, double time_step);

/// At which step a rollout diverged and why.
std::string divergence_message(const std::string& scene_path, const Backend& backend,
                               const Rollout& rollout);

}  // namespace nuno
