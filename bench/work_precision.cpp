#include <fmt/format.h>

#include <nuno/native.h>

#include <array>
#include <cmath>
#include <memory>
#include <numeric>

#include "convergence.h"
#include "problems.h"
#include "sections.h"

namespace nuno::bench {

void work_precision(Report& report, const Options& options) {
  report.begin(
      "work-precision",
      "One core, CPU time a rollout against what E is off at 0, half the best and the best "
      "gain;\n"
      "straight-to-s, 32 particles. Native batch: 64 gains, per gain. Plain: semi-implicit "
      "Euler, scalar,\nwith the launch that is exact for its steps, or the paper's.");
  const OnCores one(1);
  const Problem problem = make_problem(straight_to_s(32));
  const double length = problem.cloth().size;
  const std::unique_ptr<Backend> native = native::make_backend(problem);
  const Convergence convergence(*native);
  const double scale =
      problem.cloth().particle_mass / (problem.arrival_time * problem.arrival_time);
  const std::vector<double> gains = spread_gains(scale, 64);
  const Effort effort{options.quick ? 3 : 9, 0.005};

  // From the longest stable step, which the engine cuts any wish to.
  double previous = 0;
  for (Index steps = native::make_backend(with_time_step(problem, problem.arrival_time))->steps();
       steps < 20 * native->steps(); steps *= 2) {
    const std::unique_ptr<Backend> backend = native::make_backend(
        with_time_step(problem, problem.arrival_time / static_cast<double>(steps)));
    const double off = convergence.off(*backend) / length;
    const std::array<Run, 2> runs = {
        Run{[&] {
          return backend->errors({&gains[1], 1}).front();
        }},
        Run{[&] {
          const std::vector<double> errors = backend->errors(gains);
          return std::accumulate(errors.begin(), errors.end(), 0.0);
        }},
    };
    const auto times = interleave(runs, effort, Clock::cpu);
    const std::string name = fmt::format("native, {} steps", backend->steps());
    report.add(name, "E off by", "length", exactly(off));
    report.add(name, "fell by", "×", exactly(previous > 0 ? previous / off : NAN));
    report.add(name, "scalar", "ms", scaled(statistics(times[0]), 1e3));
    report.add(name, "batch", "ms", scaled(statistics(times[1]), 1e3 / 64));
    previous = off;
  }
  for (const PlainLaunch launch : {PlainLaunch::exact, PlainLaunch::paper}) {
    previous = 0;
    Index steps = PlainChain::fewest_steps(problem);
    for (int i = 0; i < 6; ++i, steps *= 2) {
      const PlainChain plain(problem, steps, launch);
      const double off = convergence.off(plain) / length;
      const std::string name = fmt::format(
          "plain{}, {} steps", launch == PlainLaunch::paper ? ", paper's launch" : "", steps);
      report.add(name, "E off by", "length", exactly(off));
      report.add(name, "fell by", "×", exactly(previous > 0 ? previous / off : NAN));
      previous = off;
      if (launch == PlainLaunch::paper) continue;  // takes the same time
      const std::array<Run, 1> runs = {Run{[&] { return plain.error(gains[1]); }}};
      const auto times = interleave(runs, effort, Clock::cpu);
      report.add(name, "scalar", "ms", scaled(statistics(times[0]), 1e3));
    }
  }
  report.end();
}

}  // namespace nuno::bench
