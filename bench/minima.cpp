#include <fmt/format.h>

#include <nuno/native.h>
#include <nuno/optimize.h>
#include <nuno/scene_file.h>

#include <algorithm>
#include <array>
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
Evaluation scan_and_brent(const Objective& objective) {
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
  if (errors[lowest] <= brent.second) return {gains[lowest], errors[lowest]};
  return {brent.first, brent.second};
}

/// Is E at both gains that of half the step, to a thousandth of the cloth's length? Beyond, a
/// minimum is one of the discretisation and not of the cloth.
bool resolved(const Backend& native, const Evaluation& a, const Evaluation& b) {
  const std::unique_ptr<Backend> finer =
      native::make_backend(with_time_step(native.problem(), 0.5 * native.time_step()));
  const std::array gains = {a.gain, b.gain};
  const std::vector<double> errors = finer->errors(gains);
  const double tolerance = 1e-3 * native.problem().cloth().size;
  return std::abs(errors[0] - a.error) <= tolerance && std::abs(errors[1] - b.error) <= tolerance;
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
  for (ChainScene& scene : scene_library::family(options.quick ? 8 : 48)) {
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
  const std::vector<ChainScene> all = scenes(options);
  int not_above_scan = 0, below_scan = 0, below_descent = 0, resolved_scenes = 0;
  double evaluations = 0;
  double worst_over_descent = -1, worst_over_scan = -1;
  for (const ChainScene& scene : all) {
    const Problem problem = make_problem(scene);
    const std::unique_ptr<Backend> native = native::make_backend(problem);
    const Objective ours = objective(*native);
    const OptimizeSummary found = global_search(ours);
    const Evaluation scan = scan_and_brent(ours);
    const double length = problem.cloth().size;
    const double over_scan = (found.error - scan.error) / length;
    const double over_descent = (found.error - steepest_descent(ours).error) / length;
    not_above_scan += over_scan <= tolerance;
    below_scan += over_scan < -1e-4;
    below_descent += over_descent < -1e-4;
    evaluations += static_cast<double>(found.evaluations) / static_cast<double>(all.size());
    const bool counts = resolved(*native, {found.gain, found.error}, scan);
    resolved_scenes += counts;
    worst_over_descent = std::max(worst_over_descent, over_descent);
    if (counts) worst_over_scan = std::max(worst_over_scan, over_scan);
    if (over_scan > tolerance || over_descent > tolerance) {
      fmt::print(
          "  {}: {:.5f} of the length{}; {:+.0e} against the scan, {:+.0e} against the "
          "descent\n",
          scene.name, found.error / length, counts ? "" : ", not resolved", over_scan,
          over_descent);
    }
  }
  report.add("global search", "scenes", "", exactly(static_cast<double>(all.size())));
  report.add("global search", "mean evaluations", "", exactly(evaluations));
  report.add("global search", "E resolved", "", exactly(resolved_scenes));
  report.add("global search", "not above the scan", "", exactly(not_above_scan));
  report.add("global search", "far below the scan", "", exactly(below_scan));
  report.add("global search", "far below the descent", "", exactly(below_descent));
  report.end();
  report.check(worst_over_descent <= tolerance,
               fmt::format("never a worse minimum than the descent, in {} scenes (the closest: "
                           "{:+.0e} of the length)",
                           all.size(), worst_over_descent));
  report.check(worst_over_scan <= tolerance,
               fmt::format("nor than the scan with Brent, in the {} where E at both minima is that "
                           "of half the step (the closest: {:+.0e})",
                           resolved_scenes, worst_over_scan));
}

}  // namespace nuno::bench
