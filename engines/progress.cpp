#include <nuno/progress.h>

#include <nuno/conditioning.h>
#include <nuno/output.h>

#include <fmt/format.h>

#include <functional>
#include <memory>

namespace nuno {

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
