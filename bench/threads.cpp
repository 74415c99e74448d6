#include <fmt/format.h>

#include <nuno/native.h>

#include <array>
#include <memory>
#include <numeric>
#include <optional>

#include "problems.h"
#include "sections.h"

namespace nuno::bench {

void threads(Report& report, const Options& options) {
  const std::unique_ptr<Backend> native = native::make_backend(make_problem(straight_to_s(32)));
  report.begin("threads", fmt::format("Wall clock: E of 200 gains on one core and on two, threads "
                                      "and all;\nstraight-to-s, 32 particles, {} steps.",
                                      native->steps()));
  const Problem& problem = native->problem();
  const double scale =
      problem.cloth().particle_mass / (problem.arrival_time * problem.arrival_time);
  const std::vector<double> gains = spread_gains(scale, 200);
  const auto scan = [&] {
    const std::vector<double> errors = native->errors(gains);
    return std::accumulate(errors.begin(), errors.end(), 0.0);
  };
  std::optional<OnCores> cores;
  const auto on = [&](int count) {
    return [&cores, count] {
      cores.reset();
      cores.emplace(count);
    };
  };
  on(1)();
  const std::vector<double> alone = native->errors(gains);
  cores.reset();
  report.check(native->errors(gains) == alone, "one core and all of them give the same bits");
  if (usable_cores() < 2) {
    report.check(true, "there is one core only: no ratio");
    return;
  }
  const std::array<Run, 2> runs = {Run{scan, on(1)}, Run{scan, on(2)}};
  const auto times = interleave(runs, {options.quick ? 25 : 75, 0.02}, Clock::wall);
  report.add("one core", "200 gains", "ms", scaled(statistics(times[0]), 1e3));
  report.add("two cores", "200 gains", "ms", scaled(statistics(times[1]), 1e3));
  report.end();
  report.add_ratio("two_threads_over_one", ratio(times[0], times[1]));
}

}  // namespace nuno::bench
