#include <fmt/format.h>

#include <nuno/conditioning.h>
#include <nuno/native.h>
#include <nuno/optimize.h>
#include <nuno/rollout.h>
#include <nuno/scene_file.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
// Boost 1.74's header needs <cstdint> and does not include it.
#include <boost/math/tools/minima.hpp>

#include "scene_library.h"
#include "sections.h"

namespace nuno::bench {
namespace {

/// Where E(α) is lowest by Brent between two gains.
Evaluation lowest_between(const Objective& objective, double from, double to) {
  const auto [gain, error] = boost::math::tools::brent_find_minima(
      [&](double at) {
        return objective.errors({&at, 1}).front();
      },
      from, to, 26);
  return {gain, error};
}

bool calm(const Backend& backend, double gain) {
  return sensitivity(backend, rollout(backend, gain)) <= largest_calm_sensitivity;
}

/// The oracle: 2000 gains over all that the time step resolves, evenly spaced in √α, along which E
/// swings evenly, and Brent beside each that is lower than its neighbours. The lowest of those well
/// below `error` [m] at which the flight is well-conditioned; none, where there is none.
std::optional<Evaluation> lower_minimum(const Backend& backend, const Objective& objective,
                                        double error) {
  const double last =
      std::min(GlobalSearchOptions().largest_gain * objective.gain_scale, objective.largest_gain);
  std::vector<double> gains(2000);
  for (std::size_t i = 0; i < gains.size(); ++i) {
    gains[i] = last * std::pow(static_cast<double>(i) / 1999, 2);
  }
  const std::vector<double> errors = objective.errors(gains);
  std::optional<Evaluation> lowest;
  for (std::size_t i = 1; i + 1 < gains.size(); ++i) {
    // Brent takes a minimum of the scan down by less than a fifth.
    if (errors[i] > errors[i - 1] || errors[i] > errors[i + 1] || errors[i] > 1.2 * error) continue;
    const Evaluation at = lowest_between(objective, gains[i - 1], gains[i + 1]);
    if (!(at.error < (lowest ? lowest->error : error))) continue;
    if (calm(backend, at.gain)) lowest = at;
  }
  return lowest;
}

std::vector<ChainScene> scenes(const Options& options) {
  std::vector<std::string> paths;
  for (const auto& entry : std::filesystem::directory_iterator(options.scenes)) {
    if (entry.path().extension() == ".json") paths.push_back(entry.path().string());
  }
  std::ranges::sort(paths);
  std::vector<ChainScene> result;
  result.reserve(paths.size());
  for (const std::string& path : paths) result.push_back(std::get<ChainScene>(read_scene(path)));
  for (ChainScene& scene : scene_library::family(options.quick ? 8 : 64)) {
    result.push_back(std::move(scene));
  }
  return result;
}

}  // namespace

void minima(Report& report, const Options& options) {
  constexpr double tolerance = 1e-4;  // of L; E itself is off by as much
  // Where calm flights and noise mix, a valley a third of a radian wide may stay unseen.
  constexpr double tolerance_beside_noise = 1e-3;
  report.begin("minima",
               "Errors of the global search and of two others on the same objective, the native "
               "chain's own:\na scan of 2000 gains with Brent beside every minimum, and steepest "
               "descent from α = 0.");
  const std::vector<ChainScene> all = scenes(options);
  int below_descent = 0, fragile = 0, above_scan = 0;
  double evaluations = 0, worst_over_descent = -1, worst_over_scan = 0;
  for (const ChainScene& scene : all) {
    const Problem problem = make_problem(scene);
    const std::unique_ptr<Backend> native = native::make_backend(problem);
    const Objective ours = objective(*native);
    const OptimizeSummary found = global_search(ours);
    const double length = problem.cloth().size;
    const std::optional<Evaluation> scan = lower_minimum(*native, ours, found.error);
    const double over_scan = scan ? (found.error - scan->error) / length : 0;
    const OptimizeSummary descent = steepest_descent(ours);
    const double over_descent = (found.error - descent.error) / length;
    below_descent += over_descent < -1e-4;
    fragile += !calm(*native, found.gain);
    evaluations += static_cast<double>(found.evaluations) / static_cast<double>(all.size());
    above_scan += over_scan > tolerance;
    if (calm(*native, descent.gain)) {
      worst_over_descent = std::max(worst_over_descent, over_descent);
    }
    worst_over_scan = std::max(worst_over_scan, over_scan);
    if (over_scan > tolerance || over_descent > tolerance) {
      fmt::print(
          "  {}: {:.5f} of the length; {:+.0e} against the scan, {:+.0e} against the descent\n",
          scene.name, found.error / length, over_scan, over_descent);
    }
  }
  report.add("global search", "scenes", "", exactly(static_cast<double>(all.size())));
  report.add("global search", "mean evaluations", "", exactly(evaluations));
  report.add("global search", "fragile", "", exactly(fragile));
  report.add("global search", "above the scan", "", exactly(above_scan));
  report.add("global search", "far below the descent", "", exactly(below_descent));
  report.end();
  report.check(worst_over_descent <= tolerance,
               fmt::format("never a worse minimum than a well-conditioned one of the descent, "
                           "in {} scenes (the closest: {:+.0e} of the length)",
                           all.size(), worst_over_descent));
  report.check(worst_over_scan <= tolerance_beside_noise,
               fmt::format("nor than one of the scan (the worst: {:+.0e})", worst_over_scan));
}

}  // namespace nuno::bench
