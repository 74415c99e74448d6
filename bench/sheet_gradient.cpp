// What the gradient of E by every reference correction, the launch and the gain costs, beside E.

#include <fmt/format.h>

#include <nuno/native.h>
#include <nuno/reference_motion.h>
#include <nuno/refine.h>
#include <nuno/rollout.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "problems.h"
#include "sections.h"

namespace nuno::bench {
namespace {

double error_of(const Backend& backend, double gain) {
  return backend.errors(std::array{gain}).front();
}

/// The gradient along itself is the central difference, in one correction after another and in the
/// gain.
void check_gradient(Report& report, const Problem& problem, double gain) {
  const auto native = native::make_backend(problem);
  const RolloutGradient gradient = native->error_gradient(gain);
  const auto off = [](double exact, auto&& value, double size) {
    const auto central = [&](double e) { return (value(e) - value(-e)) / (2 * e); };
    return std::abs((4 * central(size / 2) - central(size)) / (3 * exact) - 1);
  };
  double worst = off(
      gradient.gain * gain, [&](double e) { return error_of(*native, gain * (1 + e)); }, 1e-2);
  for (std::size_t k = 0; k < correction_powers.size(); ++k) {
    const Points& slope = gradient.reference_correction[k];
    const Points way = slope / slope.cwiseAbs().maxCoeff();
    const auto moved = [&](double e) {
      Problem other = problem;
      other.reference_correction.assign(correction_powers.size(), Points::Zero(3, way.cols()));
      other.reference_correction[k] = e * way;
      return error_of(*native::make_backend(other), gain);
    };
    const double small = 1e-5 * problem.cloth().size;
    worst = std::max(worst, off(slope.cwiseProduct(way).sum(), moved, small));
  }
  report.check(worst < 1e-6, fmt::format("{} particles: the gradient is the central difference to "
                                         "{:.0e} of itself",
                                         problem.cloth().particles(), worst));
}

/// The most memory that `work` takes, with a problem and an engine of its own [bytes].
template <typename Work>
double memory_of(Index columns, double gain, Work&& work) {
  const double before = memory_in_use();
  reset_peak_memory();
  const auto native = native::make_backend(thrown_sheet(columns));
  work(*native, gain);
  return peak_memory() - before;
}

void measure_sheet(Report& report, Index columns, const Effort& effort) {
  const Problem problem = thrown_sheet(columns);
  const auto native = native::make_backend(problem);
  const double gain = tracking_gain(*native);
  check_gradient(report, problem, gain);

  const std::vector<Run> runs = {Run{[&] { return native->error_gradient(gain).gain; }},
                                 Run{[&] { return error_of(*native, gain); }},
                                 Run{[&] { return rollout(*native, gain).error.mean; }}};
  const auto times = interleave(runs, effort, Clock::cpu);
  const Index particles = problem.cloth().particles();
  const std::string name = fmt::format("{} particles, {} steps", particles, native->steps());
  report.add(name, "E", "ms", scaled(statistics(times[1]), 1e3));
  report.add(name, "rollout", "ms", scaled(statistics(times[2]), 1e3));
  report.add(name, "E and gradient", "ms", scaled(statistics(times[0]), 1e3));

  const double flown = memory_of(columns, gain, [](const Backend& engine, double at) {
    rollout(engine, at, {.frames_per_second = 60});
  });
  const double back =
      memory_of(columns, gain, [](const Backend& engine, double at) { engine.error_gradient(at); });
  report.add(name, "rollout with frames", "MB", exactly(1e-6 * flown));
  report.add(name, "gradient", "MB", exactly(1e-6 * back));
  report.add_ratio(fmt::format("sheet_gradient_over_value_{}", particles),
                   ratio(times[0], times[1]));
  report.add_ratio(fmt::format("sheet_gradient_memory_{}", particles), exactly(back / flown));
}

}  // namespace

void sheet_gradient(Report& report, const Options& options) {
  const OnCores one(1);
  report.begin("gradient of a sheet",
               "One core, CPU time: E alone; E and its gradient by the gain, the launch and all "
               "reference corrections.\nMemory: the peak above what the process had before, of "
               "problem, engine and a rollout with 60 frames a second, or the gradient.");
  measure_sheet(report, 16, {options.quick ? 5 : 15, 0});
  measure_sheet(report, 32, {options.quick ? 3 : 9, 0});
  report.end();
}

}  // namespace nuno::bench
