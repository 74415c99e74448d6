#pragma once

#include <nuno/joint_search.h>
#include <nuno/optimize.h>
#include <nuno/rollout.h>

#include <string>
#include <thread>

namespace nuno {

/// Says on standard error at which step a rollout diverged and why.
void report_divergence(const std::string& scene_path, const Backend& backend,
                       const Rollout& rollout);

/// While it lives, tells a person, off a terminal too, what work will take that takes long, and
/// every half minute how long it has taken.
class LongWork {
 public:
  /// As much work as `flights` of the backend's, one after another; it times a few steps of one.
  LongWork(const Backend& backend, const std::string& label, double flights);

 private:
  std::jthread teller_;
};

/// As much work as a search for the best gain is, in flights one after another.
double flights_of_search(const Backend& backend);

/// The same objective, which counts its rollouts for a person at a terminal.
Objective with_progress(Objective objective, const std::string& label);
JointObjective with_progress(JointObjective objective, const std::string& label);

}  // namespace nuno
