#include "studio/throw.h"

#include <nuno/conditioning.h>

#include <cmath>
#include <utility>

namespace nuno::studio {
namespace {

// A search for an eye that watches the shape change: a thousandth of the error more or less is
// below what it sees.
constexpr GlobalSearchOptions while_changing = {
    .rounds = 6, .gain_tolerance = 1e-3, .error_tolerance = 1e-3};

OptimizeSummary search(const Options& options, const Objective& objective) {
  if (!options.warm_start) return run_optimizer(options.optimizer, objective);
  GlobalSearchOptions quick = while_changing;
  quick.warm_start = options.warm_start;
  return global_search(objective, quick);
}

/// Two errors more in each wide gap of a search's, for the curve to be smooth to the eye.
std::vector<Evaluation> between(const std::vector<Evaluation>& searched,
                                const Objective& objective) {
  constexpr double wide = 1.1;
  std::vector<double> gains;
  for (std::size_t i = 1; i < searched.size(); ++i) {
    const double from = searched[i - 1].gain, to = searched[i].gain;
    if (!(from > 0 && to > wide * from)) continue;
    for (const double along : {1.0 / 3, 2.0 / 3}) {
      gains.push_back(from * std::pow(to / from, along));
    }
  }
  const std::vector<double> errors = objective.errors(gains);
  std::vector<Evaluation> result;
  for (std::size_t i = 0; i < gains.size(); ++i) result.push_back({gains[i], errors[i]});
  return result;
}

RolloutOptions kept_frames(const Options& options, const SceneFile& file, KeptFrames frames) {
  if (frames == KeptFrames::of_scene) return {.frames_per_second = file.scene.frames_per_second};
  return {.frames_per_second = static_cast<double>(options.frames) / file.scene.arrival_time,
          .tail = options.frames > 0 ? options.after : 0,
          .keeps_forces = true};
}

void fly(Throw& result, double gain, const RolloutOptions& options, bool is_judged) {
  if (!is_judged) {
    result.flight = rollout(*result.backend, gain, options);
    return;
  }
  JudgedRollout flown = judged_rollout(*result.backend, result.file, gain, options);
  if (flown.finer) result.backend = std::move(flown.finer);
  result.flight = std::move(flown.flight);
  result.sensitivity = flown.sensitivity;
}

}  // namespace

Throw throw_cloth(const Request& request, std::optional<double> alpha, KeptFrames frames) {
  const Options& options = request.options;
  Throw result;
  result.file = read_scene(request);
  SceneFile& file = result.file;
  if (frames == KeptFrames::of_scene) require_few_frames_in_file(file);
  const auto made_ready = [&] {
    return alpha ? make_backend_for_gain(options.backend, file, *alpha, "alpha")
                 : make_backend(options.backend, file);
  };
  result.backend = made_ready();
  require_quick(file, *result.backend, options);
  double gain = alpha.value_or(0);
  if (!alpha) {
    const Objective errors = objective(*result.backend);
    result.found = search(options, errors);
    gain = result.found->gain;
    // Where they are cheap.
    if (errors.samples && !options.warm_start) {
      result.between = between(result.found->history, errors);
    }
  }
  if (options.refine) {
    RefineSummary refined = refine_on(options.backend, file);
    if (refined.flight.error.mean < rollout(*result.backend, gain).error.mean) {
      gain = refined.flight.gains.rest;
      file.problem.reference_correction = refined.reference_correction;
      result.refined = std::move(refined);
      result.backend = made_ready();
    }
  }
  const bool is_judged = options.judge || frames == KeptFrames::of_scene;
  RolloutOptions kept = kept_frames(options, file, frames);
  fly(result, gain, kept, is_judged);
  if (kept.tail > 0 && diverged(result.flight)) {  // after it arrived, maybe: then it did arrive
    kept.tail = 0;
    fly(result, gain, kept, is_judged);
  }
  return result;
}

}  // namespace nuno::studio
