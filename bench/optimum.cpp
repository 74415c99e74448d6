#include <fmt/format.h>

#include <nuno/native.h>
#include <nuno/optimize.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>

#include "convergence.h"
#include "paper_procedure.h"
#include "problems.h"
#include "scene_library.h"
#include "sections.h"

namespace nuno::bench {
namespace {

// What E(α) may be off, on either side, at the gains of Convergence: of the cloth's length.
constexpr double tolerance = 1e-4;

/// Steps that grow by a quarter of an octave.
Index refined(Index steps, int quarter) {
  return static_cast<Index>(std::ceil(static_cast<double>(steps) * std::exp2(0.25 * quarter)));
}

/// The native chain at its own step or, should that be too long, at the longest that keeps the
/// tolerance.
std::unique_ptr<Backend> native_within_tolerance(const Problem& problem,
                                                 const Convergence& convergence) {
  const Index own = native::make_backend(problem)->steps();
  for (int quarter = 0; quarter < 40; ++quarter) {
    std::unique_ptr<Backend> native = native::make_backend(
        with_time_step(problem, problem.arrival_time / static_cast<double>(refined(own, quarter))));
    if (convergence.off(*native) <= tolerance * problem.cloth().size) return native;
  }
  throw Refusal("optimum: the native chain does not converge");
}

/// The plain chain at the longest step that is stable and keeps the tolerance.
PlainChain plain_within_tolerance(const Problem& problem, PlainLaunch launch,
                                  const Convergence& convergence) {
  const Index fewest = PlainChain::fewest_steps(problem);
  for (int quarter = 0; quarter < 40; ++quarter) {
    PlainChain plain(problem, refined(fewest, quarter), launch);
    if (convergence.off(plain) <= tolerance * problem.cloth().size) return plain;
  }
  throw Refusal("optimum: the plain chain does not converge to the native one");
}

/// The paper's procedure started again and again, a start for every oscillation of the control that
/// ends at arrival, until it is told that `enough` [m] is reached: a descent finds one valley only.
OptimizeSummary restarted_descent(const Objective& objective, double largest_gain, double enough) {
  OptimizeSummary best;
  Index evaluations = 0;
  for (int turn = 0;; ++turn) {
    SteepestDescentOptions options;
    options.first_gain = objective.gain_scale * std::pow(std::numbers::pi * turn, 2);
    if (options.first_gain > largest_gain) break;
    const OptimizeSummary found = steepest_descent(objective, options);
    evaluations += found.evaluations;
    if (turn == 0 || found.error < best.error) best = found;
    if (best.error <= enough) break;
  }
  best.evaluations = evaluations;
  return best;
}

void add_optimum(Report& report, const std::string& name, Index steps, double off,
                 const Statistics& time, const OptimizeSummary& summary, double limit) {
  report.add(name, "steps", "", exactly(static_cast<double>(steps)));
  report.add(name, "E off by", "length", exactly(off));
  report.add(name, "time", "ms", scaled(time, 1e3));
  report.add(name, "evaluations", "", exactly(static_cast<double>(summary.evaluations)));
  report.add(name, "best gain", "N/m", exactly(summary.gain));
  report.add(name, "E there, converged", "length", exactly(limit));
}

/// Refuses to go on unless the plain chain and the native one tend to one limit for small steps.
void check_limit(Report& report, Index particles, double length, const Convergence& convergence,
                 const PlainChain& exact, const PlainChain& finer) {
  report.check(
      convergence.uncertainty() < 0.1 * tolerance * length,
      fmt::format("N = {}: the limit of E for small steps is known to {:.0e} of the length",
                  particles, convergence.uncertainty() / length));
  report.check(convergence.off(finer) < 0.5 * tolerance * length,
               fmt::format("N = {}: the plain chain converges to the native one: {:.0e} of the "
                           "length at {} steps, {:.0e} at {}",
                           particles, convergence.off(exact) / length, exact.steps(),
                           convergence.off(finer) / length, finer.steps()));
}

void against_paper(Report& report, Index particles, const Effort& effort) {
  const Problem problem = make_problem(straight_to_s(particles));
  const double length = problem.cloth().size;
  const Convergence convergence(*native::make_backend(problem));
  const std::unique_ptr<Backend> native = native_within_tolerance(problem, convergence);
  const PlainChain exact = plain_within_tolerance(problem, PlainLaunch::exact, convergence);
  const PlainChain paper = plain_within_tolerance(problem, PlainLaunch::paper, convergence);
  const PlainChain finer(problem, 8 * exact.steps(), PlainLaunch::exact);
  check_limit(report, particles, length, convergence, exact, finer);

  const Objective ours = objective(*native);
  const Objective with_paper = paper.objective();
  const Objective with_exact = exact.objective();
  const double largest_gain =
      std::min(GlobalSearchOptions().largest_gain * ours.gain_scale, ours.largest_gain);
  const double enough = convergence.error(global_search(ours).gain) + tolerance * length;
  std::array<OptimizeSummary, 4> found;
  const std::array<Run, 4> runs = {
      Run{[&] { return (found[0] = global_search(ours)).error; }},
      Run{[&] { return (found[1] = steepest_descent(with_paper)).error; }},
      Run{[&] { return (found[2] = steepest_descent(with_exact)).error; }},
      Run{[&] { return (found[3] = restarted_descent(with_exact, largest_gain, enough)).error; }},
  };
  std::vector<std::vector<double>> times;
  {
    const OnCores one(1);
    times = interleave(runs, effort, Clock::cpu);
  }
  const std::array<std::string, 4> names = {
      fmt::format("N = {}, global search", particles),
      fmt::format("N = {}, paper's procedure", particles),
      fmt::format("N = {}, the same, exact launch", particles),
      fmt::format("N = {}, the same, restarted", particles),
  };
  const std::array<Index, 4> steps = {native->steps(), paper.steps(), exact.steps(), exact.steps()};
  const std::array<double, 4> off = {convergence.off(*native), convergence.off(paper),
                                     convergence.off(exact), convergence.off(exact)};
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const double there = native->errors({&found[i].gain, 1}).front();
    report.check(found[0].error <= there + 1e-6 * length,
                 fmt::format("{}: its gain gives {:.6f}, and the minimum found is not above that",
                             names[i], there));
    add_optimum(report, names[i], steps[i], off[i] / length, statistics(times[i]), found[i],
                convergence.error(found[i].gain) / length);
  }
  const std::string suffix = particles == 32 ? "" : fmt::format("_{}", particles);
  report.add_ratio("optimum_over_paper_procedure" + suffix, ratio(times[1], times[0]));
  report.add_ratio("optimum_over_exact_launch" + suffix, ratio(times[2], times[0]));
  report.add_ratio("optimum_over_restarted" + suffix, ratio(times[3], times[0]));

  const auto on_all = interleave(std::span(runs).first(1), effort, Clock::wall);
  report.add(names[0], "on all cores", "ms", scaled(statistics(on_all[0]), 1e3));
}

/// A chain so fine that its hinges would want more than `most_steps` gets softer ones.
Problem with_few_steps(Report& report, Index particles, Index most_steps) {
  ChainScene scene = straight_to_s(particles);
  scene.launch = Launch::inextensible;  // one that compresses would buckle so limp a cloth
  const Index wished = native::make_backend(make_problem(scene))->steps();
  if (wished > most_steps) {
    const double fewer = static_cast<double>(most_steps) / static_cast<double>(wished);
    scene.cloth.hinge_stiffness *= 0.99 * fewer * fewer;
    report.check(true, fmt::format("N = {}: hinges softened to EI = {:.1e} N·m², or it would take "
                                   "{} steps; inextensible launch",
                                   particles, scene.cloth.hinge_stiffness, wished));
  }
  return make_problem(scene);
}

void alone(Report& report, const Problem& problem, int repetitions) {
  const std::string name = fmt::format("N = {}, global search", problem.cloth().particles());
  std::unique_ptr<Backend> native = native::make_backend(problem);
  for (int attempt = 0; attempt < 4; ++attempt) {
    const std::unique_ptr<Backend> finer =
        native::make_backend(with_time_step(problem, native->time_step() / 4));
    const Objective ours = objective(*native);
    OptimizeSummary found;
    const std::array<Run, 1> runs = {Run{[&] { return (found = global_search(ours)).error; }}};
    const auto times = [&] {
      const OnCores one(1);
      return interleave(runs, {repetitions, 0}, Clock::cpu);
    }();
    const double limit = finer->errors({&found.gain, 1}).front();
    const double off = std::abs(limit - found.error) / problem.cloth().size;
    if (off < tolerance) {
      report.check(true, fmt::format("{}: E at the best gain is within {:.0e} of that at a quarter "
                                     "of the step",
                                     name, off));
      add_optimum(report, name, native->steps(), off, statistics(times[0]), found,
                  limit / problem.cloth().size);
      return;
    }
    native = native::make_backend(with_time_step(problem, native->time_step() / 2));
  }
  report.check(false, fmt::format("{}: E at the best gain converges", name));
}

/// The search takes a round more or less by chance, so it is the sum over several scenes.
void growth(Report& report, int repetitions) {
  std::vector<ChainScene> scenes = scene_library::family(5);
  scenes.push_back(straight_to_s(32));
  std::vector<std::unique_ptr<Backend>> small, large;
  for (ChainScene& scene : scenes) {
    scene.particles = 64;
    const Problem fine = make_problem(scene);
    scene.particles = 32;
    const Problem coarse = make_problem(scene);
    large.push_back(native::make_backend(fine));
    small.push_back(native::make_backend(with_time_step(coarse, large.back()->time_step())));
    // The few may take more steps than they are asked for: then the many do as well.
    if (small.back()->steps() != large.back()->steps()) {
      large.back() = native::make_backend(with_time_step(fine, small.back()->time_step()));
    }
    report.check(small.back()->steps() == large.back()->steps(),
                 fmt::format("{}: 32 and 64 particles fly in the same {} steps", scene.name,
                             large.back()->steps()));
  }
  Index evaluations_small = 0, evaluations_large = 0;
  const auto search = [](const std::vector<std::unique_ptr<Backend>>& backends, Index& count) {
    count = 0;
    double errors = 0;
    for (const auto& backend : backends) {
      const OptimizeSummary found = global_search(objective(*backend));
      count += found.evaluations;
      errors += found.error;
    }
    return errors;
  };
  const std::array<Run, 2> runs = {Run{[&] { return search(small, evaluations_small); }},
                                   Run{[&] { return search(large, evaluations_large); }}};
  const OnCores one(1);
  const auto times = interleave(runs, {repetitions, 0}, Clock::cpu);
  const auto add = [&](const std::string& name, const std::vector<double>& time, Index count) {
    report.add(name, "time", "ms", scaled(statistics(time), 1e3));
    report.add(name, "evaluations", "", exactly(static_cast<double>(count)));
  };
  add(fmt::format("same steps, {} scenes, N = 32", scenes.size()), times[0], evaluations_small);
  add(fmt::format("same steps, {} scenes, N = 64", scenes.size()), times[1], evaluations_large);
  report.add_ratio("growth_32_to_64", ratio(times[1], times[0]));
}

}  // namespace

void optimum(Report& report, const Options& options) {
  report.begin(
      "optimum",
      fmt::format(
          "One core, CPU time, to the best gain of straight-to-s. Paper's procedure: steepest "
          "descent from α = 0 with central\ndifferences over a plain scalar chain (explicit "
          "springs, semi-implicit Euler, atan2, sqrt), launched by the paper's\nequations, or "
          "with the launch that is exact for its own steps, which is ours. It ends in the first "
          "valley;\nrestarted: once for every turn of the control's oscillation, until it is told "
          "that it is as low as the global search.\nEvery chain keeps E at 0, half the best and "
          "the best gain within {} of the length of the limit of small steps, at\nthe longest "
          "such step (to a quarter of an octave; the native one's not above its own choice).",
          tolerance));
  against_paper(report, 32, options.quick ? Effort{7, 0.01} : Effort{15, 0.02});
  against_paper(report, 64, {options.quick ? 1 : 7, 0});
  growth(report, options.quick ? 3 : 9);
  const Problem fine = make_problem(straight_to_s(128));
  alone(report, fine, options.quick ? 1 : 7);
  const Index most_steps = native::make_backend(fine)->steps() / (options.quick ? 4 : 1);
  alone(report, with_few_steps(report, 1024, most_steps), options.quick ? 1 : 3);
  report.end();
}

}  // namespace nuno::bench
