#include <nuno/search.h>

#include <nuno/output.h>
#include <nuno/pareto_front.h>
#include <nuno/progress.h>
#include <nuno/robust.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <thread>

namespace nuno {
namespace {

/// The gain of least error.
Optimization search_gain(const SearchOptions& options, const SceneFile& file,
                         const Backend& backend, Telling telling) {
  const RobustOptions robustness;
  Objective errors = options.robust ? robust_objective(backend, robustness) : objective(backend);
  if (telling == Telling::progress) errors = with_progress(errors, file.scene.name);
  const std::string optimizer = options.optimizer.value_or(std::string(optimizer_names.front()));
  Optimization found{optimizer, run_optimizer(optimizer, errors)};
  if (options.robust) {
    found.robust_error = found.summary.error;
    found.summary.evaluations *= 1 + static_cast<Index>(robustness.perturbations);
  }
  return found;
}

constexpr Index gains_of_front = 64;

/// The gain that keeps a limit at the least cost; if none does, the nearest to it.
Optimization search_front(const SearchOptions& options, const SceneFile& file,
                          const Backend& backend, Telling telling) {
  const auto start = std::chrono::steady_clock::now();
  Optimization found{"pareto-front", {}};
  OptimizeSummary& summary = found.summary;
  std::atomic<Index> rollouts = 0;
  const auto count = [&] { ++rollouts; };
  Objective errors = objective(backend);
  if (telling == Telling::progress) errors = with_progress(errors, file.scene.name);
  const OptimizeSummary searched = global_search(errors);
  rollouts += searched.evaluations;
  found.pareto_front = pareto_front(backend, gains_of_front, searched.history, count);
  summary.evaluations = rollouts;
  if (found.pareto_front.empty()) return found;  // every rollout diverged
  ParetoPoint point;
  if (options.error_limit) {
    const double limit = *options.error_limit * backend.cloth().size;
    const auto kept = least_effort(backend, found.pareto_front, limit, count);
    point = kept.value_or(found.pareto_front.back());
    summary.status = kept ? OptimizeStatus::converged : OptimizeStatus::budget;
    summary.reason = kept ? "the least effort within the error limit"
                          : "no gain keeps the error limit; this is the nearest";
  } else {
    point = least_error(backend, found.pareto_front, *options.effort_limit, count);
    summary.reason = "the least error within the effort limit";
  }
  summary.evaluations = rollouts;
  summary.gain = point.gain;
  summary.error = point.error;
  for (const ParetoPoint& at : found.pareto_front) summary.history.push_back({at.gain, at.error});
  summary.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return found;
}

Optimization search_single(const SearchOptions& options, const SceneFile& file,
                           const Backend& backend, Telling telling) {
  const bool has_limit = options.error_limit || options.effort_limit;
  std::optional<LongWork> told;
  if (telling == Telling::progress) {
    // A limit takes the front's flights besides, over all cores, and 30 halvings one by one.
    const double more =
        has_limit ? gains_of_front / std::max(1.0, 1.0 * std::thread::hardware_concurrency()) + 30
                  : 0;
    told.emplace(backend, file.scene.name, flights_of_search(backend) + more);
  }
  return has_limit ? search_front(options, file, backend, telling)
                   : search_gain(options, file, backend, telling);
}

/// Whether a flight serves the asked better than another: one within the limits than one without;
/// then, under an error limit, by effort, else by error.
bool is_better(const Rollout& a, const Rollout& b, const SearchOptions& options, double length) {
  const auto kept = [&](const Rollout& flight) {
    return (!options.error_limit || flight.error.mean <= *options.error_limit * length) &&
           (!options.effort_limit || flight.control_effort <= *options.effort_limit);
  };
  if (kept(a) != kept(b)) return kept(a);
  return options.error_limit && kept(a) ? a.control_effort < b.control_effort
                                        : a.error.mean < b.error.mean;
}

RefineOptions limits_of(const SearchOptions& options) {
  RefineOptions limits;
  if (options.error_limit) limits.tolerance = std::max(limits.tolerance, *options.error_limit);
  if (options.effort_limit) limits.effort_limit = *options.effort_limit;
  return limits;
}

/// What refining takes, in flights; a sheet takes a dozen or two.
constexpr double flights_of_refinement = 25;

/// Puts a refined flight in the place of the answer's, if it is better.
void refine_answer(const SceneFile& file, const SearchOptions& options, Telling telling,
                   SearchAnswer& answer) {
  const std::string_view name = answer.backend->name();
  std::optional<LongWork> told;
  if (telling == Telling::progress) {
    told.emplace(*answer.backend, file.scene.name + ", refinement", flights_of_refinement);
  }
  RefineSummary refined = refine_on(name, file, limits_of(options));
  const Rollout unrefined = rollout(*answer.backend, answer.gains);
  answer.left_refinement_out =
      !is_better(refined.flight, unrefined, options, file.problem.cloth().size);
  if (answer.left_refinement_out) return;
  Problem problem = file.problem;
  problem.reference_correction = refined.reference_correction;
  answer.backend = backend_maker(name, file)(problem);
  answer.gains = refined.flight.gains;
  answer.how.refinement = std::move(refined);
}

}  // namespace

void require_compatible(const SearchOptions& options) {
  const auto refuse = [](const char* message) { throw InputError(message); };
  const bool has_limit = options.error_limit || options.effort_limit;
  if (options.error_limit && options.effort_limit) {
    refuse("--effort-limit: does not go with --error-limit");
  }
  if (options.optimizer && has_limit) refuse("--optimizer: does not go with a limit");
  if (options.robust && has_limit) refuse("--robust: does not go with a limit");
  if (options.coefficients > 1 && (options.robust || has_limit)) {
    refuse("--coefficients: does not go with --robust or a limit");
  }
  if (options.refine && (options.robust || options.coefficients > 1)) {
    refuse("--refine: does not go with --coefficients or --robust, it has a gain of its own");
  }
}

SearchAnswer search(const SceneFile& file, std::unique_ptr<Backend> backend,
                    const SearchOptions& options, Telling telling) {
  SearchAnswer answer{search_single(options, file, *backend, telling)};
  answer.gains = answer.how.summary.gain;
  if (options.coefficients > 1) {
    JointObjective errors = joint_objective(*backend);
    if (telling == Telling::progress) errors = with_progress(errors, file.scene.name);
    const Evaluation start{answer.how.summary.gain, answer.how.summary.error};
    answer.how.joint = joint_search(errors, start, {.groups = options.coefficients});
    answer.gains = answer.how.joint->stages.back().gains;
  }
  if (telling == Telling::progress) clear_progress();
  answer.backend = std::move(backend);
  if (options.refine) refine_answer(file, options, telling, answer);
  return answer;
}

}  // namespace nuno
