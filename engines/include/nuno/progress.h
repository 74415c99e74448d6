#pragma once

#include <nuno/joint_search.h>
#include <nuno/optimize.h>
#include <nuno/rollout.h>

#include <string>

namespace nuno {

/// Says on standard error at which step a rollout diverged and why.
void report_divergence(const std::string& scene_path, const Backend& backend,
                       const Rollout& rollout);

/// The same objective, which counts its rollouts for a person at a terminal.
Objective with_progress(Objective objective, const std::string& label);
JointObjective with_progress(JointObjective objective, const std::string& label);

}  // namespace nuno
