#include <fmt/format.h>

#include <nuno/native.h>
#include <nuno/optimize.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <memory>
// Boost 1.74's header needs <cstdint> and does not include it.
#include <boost/math/tools/minima.hpp>

#include "scene_library.h"
#include "sections.h"

namespace nuno::bench {
namespace {

/// The oracle: 200 gains over the range that the search scans, 0 besides, and Brent beside the
/// lowest.
double scan_and_brent(const Objective& objective) {
  const GlobalSearchOptions range;
  const double first = range.smallest_gain * objective.gain_scale;
  const double last = std::max(
      2 * first, std::min(range.largest_gain * objective.gain_scale, objective.largest_gain));
  std::vector<double> gains = {0};
  for (int i = 0; i < 200; ++i) gains.push_back(first * std::pow(last / first, i / 199.0));
  const std::vector<double> errors = objective.errors(gains);
  const auto lowest = static_cast<std::size_t>(std::ranges::min_element(errors) - errors.begin());
  const auto brent = boost::math::tools::brent_find_minima(
      [&](double gain) {
        return objective.errors({&gain, 1}).front();
      },
      gains[lowest == 0 ? 0 : lowest - 1], gains[std::min(lowest + 1, gains.size() - 1)], 26);
  return std::min(brent.second, errors[lowest]);
}

std::vector<Scene> scenes(const Options& options) {
  std::vector<std::string> paths;
  for (const auto& entry : std::filesystem::directory_iterator(options.scenes)) {
    if (entry.path().extension() == ".json") paths.push_back(entry.path().string());
  }
  std::ranges::sort(paths);
  std::vector<Scene> result;
  for (const std::string& path : paths) result.push_back(read_scene(path));
  for (Scene& scene : scene_library::family(options.quick ? 8 : 48)) {
    result.push_back(std::move(scene));
  }
  return result;
}

}  // namespace

void minima(Report& report, const Options& options) {
  // E itself is off by a hundred times as much; nobody sees a millionth of the length.
  constexpr double tolerance = 1e-6;
  report.begin("minima",
               "Errors of the global search and of two others on the same objective, the native "
               "chain's own:\na scan of 200 gains with Brent beside the lowest, and steepest "
               "descent from α = 0.");
  const std::vector<Scene> all = scenes(options);
  int not_above_scan = 0, not_above_descent = 0, below_scan = 0, below_descent = 0;
  double evaluations = 0;
  std::string worst_name = "none";
  double worst = -1;
  std::vector<std::string> failures;
  for (const Scene& scene : all) {
    const Problem problem = make_problem(scene);
    const std::unique_ptr<Backend> native = native::make_backend(problem);
    const Objective ours = objective(*native);
    const OptimizeSummary found = global_search(ours);
    const double scan = scan_and_brent(ours);
    const double descent = steepest_descent(ours).error;
    const double length = problem.chain.length;
    const auto over = [&](double other) { return (found.error - other) / length; };
    not_above_scan += over(scan) <= tolerance;
    not_above_descent += over(descent) <= tolerance;
    below_scan += over(scan) < -1e-4;
    below_descent += over(descent) < -1e-4;
    evaluations += static_cast<double>(found.evaluations) / static_cast<double>(all.size());
    if (over(scan) > tolerance || over(descent) > tolerance) {
      failures.push_back(fmt::format("  {}: {:.5f} of the length; scan {:.5f}, descent {:.5f}\n",
                                     scene.name, found.error / length, scan / length,
                                     descent / length));
    }
    if (const double most = std::max(over(scan), over(descent)); most > worst) {
      worst = most;
      worst_name = scene.name;
    }
  }
  const double count = static_cast<double>(all.size());
  report.add("global search", "scenes", "", exactly(count));
  report.add("global search", "mean evaluations", "", exactly(evaluations));
  report.add("global search", "not above the scan", "", exactly(not_above_scan));
  report.add("global search", "far below the scan", "", exactly(below_scan));
  report.add("global search", "not above the descent", "", exactly(not_above_descent));
  report.add("global search", "far below the descent", "", exactly(below_descent));
  report.end();
  for (const std::string& failure : failures) fmt::print("{}", failure);
  report.check(worst <= tolerance,
               fmt::format("never a worse minimum, in {} scenes (the closest, {}: {:+.0e} of the "
                           "length)",
                           all.size(), worst_name, worst));
}

}  // namespace nuno::bench
