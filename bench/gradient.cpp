#include <fmt/format.h>

#include <nuno/native.h>

#include <array>
#include <cmath>
#include <memory>
#include <numeric>

#include "problems.h"
#include "sections.h"

namespace nuno::bench {

void gradient(Report& report, const Options& options) {
  const OnCores one(1);
  const std::unique_ptr<Backend> native = native::make_backend(make_problem(straight_to_s(32)));
  report.begin("gradient", fmt::format("One core, CPU time: E and dE/dα of 64 gains together, and "
                                       "E of the same gains alone;\nstraight-to-s, 32 particles, "
                                       "{} steps.",
                                       native->steps()));
  const Problem& problem = native->problem();
  const double scale =
      problem.cloth().particle_mass / (problem.arrival_time * problem.arrival_time);
  const std::vector<double> gains = spread_gains(scale, 64);
  const std::vector<double> errors = native->errors(gains);
  const std::vector<ErrorSample> samples = native->error_samples(gains);
  double value_off = 0, derivative_off = 0;
  for (std::size_t i = 1; i < gains.size(); ++i) {
    // The truncation of the central difference is of the order 1e-8, its rounding 1e-10.
    const double delta = 1e-4 * gains[i];
    const std::array around = {gains[i] - delta, gains[i] + delta};
    const std::vector<double> beside = native->errors(around);
    const double difference = (beside[1] - beside[0]) / (2 * delta);
    const double unit = problem.cloth().size / gains[i];
    derivative_off =
        std::max(derivative_off, std::abs(samples[i].derivatives[0].error - difference) / unit);
    value_off = std::max(value_off, std::abs(samples[i].error - errors[i]) / problem.cloth().size);
  }
  report.check(value_off < 1e-9,
               fmt::format("E beside its derivative is E to {:.0e} of the length", value_off));
  report.check(
      derivative_off < 1e-5,
      fmt::format("α·dE/dα is the central difference to {:.0e} of the length", derivative_off));

  const auto value = [&] {
    const std::vector<double> found = native->errors(gains);
    return std::accumulate(found.begin(), found.end(), 0.0);
  };
  const auto both = [&] {
    double sum = 0;
    for (const ErrorSample& sample : native->error_samples(gains))
      sum += sample.derivatives[0].error;
    return sum;
  };
  const std::array<Run, 2> runs = {Run{both}, Run{value}};
  const auto times = interleave(runs, {options.quick ? 25 : 75, 0.005}, Clock::cpu);
  const double per_step = 1e9 / static_cast<double>(native->steps() * 32 * 64);
  report.add("E alone", "per particle-step and gain", "ns", scaled(statistics(times[1]), per_step));
  report.add("E and dE/dα", "per particle-step and gain", "ns",
             scaled(statistics(times[0]), per_step));
  report.end();
  report.add_ratio("gradient_over_value", ratio(times[0], times[1]));
}

}  // namespace nuno::bench
