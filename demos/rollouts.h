#pragma once

#include <nuno/optimize.h>
#include <nuno/rollout.h>

#include <string>

namespace nuno {

/// Whether a rollout has no answer to show: it diverged, or it grew so far that its error is no
/// number.
bool diverged(const Rollout& rollout);

/// At which step a rollout diverged and why.
std::string divergence_message(const std::string& scene_path, const Backend& backend,
                               const Rollout& rollout);

/// Says that on standard error.
void report_divergence(const std::string& scene_path, const Backend& backend,
                       const Rollout& rollout);

/// The same objective, which counts its rollouts for a person at a terminal.
Objective with_progress(Objective objective, const std::string& label);

}  // namespace nuno
