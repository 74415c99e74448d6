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

/// How far a flight's end shape is from that of the same flight on `finer`, the same engine at half
/// of its step: mean distance with the mass centres aligned, over L; +∞ where it diverges there.
double step_error(const Backend& finer, const Rollout& flight);

/// The words for a step error of a flight in such steps [s], and the step to take instead; empty
/// for a flight that is resolved.
std::string coarseness(double step_error, double time_step);

/// At which step a rollout diverged and why.
std::string divergence_message(const std::string& scene_path, const Backend& backend,
                               const Rollout& rollout);

}  // namespace nuno
