#include <fmt/format.h>

#include <nuno/native.h>
#include <nuno/optimize.h>

#include <array>
#include <cmath>
#include <memory>
#include <numbers>

#include "convergence.h"
#include "paper_procedure.h"
#include "problems.h"
#include "sections.h"

namespace nuno::bench {
namespace {

// What E(α) may be off, at the gains around the best one, on either side: of the cloth's length.
constexpr double tolerance = 3e-4;

/// The native chain at its own step or, should that be too long, at one that keeps the tolerance.
std::unique_ptr<Backend> native_within_tolerance(const Problem& problem,
                                                 const Convergence& convergence) {
  std::unique_ptr<Backend> native = native::make_backend(problem);
  while (convergence.off(*native) > tolerance * problem.chain.length) {
    native = native::make_backend(problem, native->time_step() / 2);
  }
  return native;
}

/// The plain chain at the longest step that is stable and keeps the tolerance, to a quarter of an
/// octave.
PlainChain plain_within_tolerance(const Problem& problem, const Convergence& convergence) {
  const double fewest = static_cast<double>(PlainChain::fewest_steps(problem));
  for (int quarter = 0;; ++quarter) {
    PlainChain plain(problem, static_cast<Index>(std::ceil(fewest * std::exp2(0.25 * quarter))));
    if (convergence.off(plain) <= tolerance * problem.chain.length) return plain;
    if (quarter > 40) throw Refusal("the plain chain does not converge to the native one");
  }
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

void against_paper(Report& report, Index particles, int repetitions) {
  const Problem problem = make_problem(straight_to_s(particles));
  const double length = problem.chain.length;
  const Convergence convergence(*native::make_backend(problem));
  report.check(
      convergence.uncertainty() < 0.1 * tolerance * length,
      fmt::format("N = {}: the limit of E for small steps is known to {:.0e} of the length",
                  particles, convergence.uncertainty() / length));
  const std::unique_ptr<Backend> native = native_within_tolerance(problem, convergence);
  const PlainChain plain = plain_within_tolerance(problem, convergence);
  const double native_off = convergence.off(*native) / length;
  const double plain_off = convergence.off(plain) / length;
  const double finer_off = convergence.off(PlainChain(problem, 8 * plain.steps())) / length;
  report.check(finer_off < 0.5 * tolerance,
               fmt::format("N = {}: the plain chain converges to the native one: {:.0e} of the "
                           "length at {} steps, {:.0e} at {}",
                           particles, plain_off, plain.steps(), finer_off, 8 * plain.steps()));

  const Objective ours = objective(*native);
  const Objective theirs = plain.objective();
  OptimizeSummary found, descended, restarted;
  const double largest_gain = GlobalSearchOptions().largest_gain * theirs.gain_scale;
  const double enough =
      convergence.error(global_search(ours).gain) + tolerance * problem.chain.length;
  const std::array<Run, 3> runs = {
      Run{[&] { return (found = global_search(ours)).error; }},
      Run{[&] { return (descended = steepest_descent(theirs)).error; }},
      Run{[&] { return (restarted = restarted_descent(theirs, largest_gain, enough)).error; }},
  };
  std::vector<std::vector<double>> times;
  {
    const OnCores one(1);
    times = interleave(runs, {repetitions, 0.02}, Clock::cpu);
  }
  const double ours_at_theirs = native->errors({&descended.gain, 1}).front();
  report.check(found.error <= ours_at_theirs,
               fmt::format("N = {}: the minimum found, {:.6f}, is not above the error at the gain "
                           "of the paper's procedure, {:.6f}",
                           particles, found.error, ours_at_theirs));
  add_optimum(report, fmt::format("N = {}, global search", particles), native->steps(), native_off,
              statistics(times[0]), found, convergence.error(found.gain) / length);
  add_optimum(report, fmt::format("N = {}, paper's procedure", particles), plain.steps(), plain_off,
              statistics(times[1]), descended, convergence.error(descended.gain) / length);
  add_optimum(report, fmt::format("N = {}, the same, restarted", particles), plain.steps(),
              plain_off, statistics(times[2]), restarted,
              convergence.error(restarted.gain) / length);
  const std::string suffix = particles == 32 ? "" : fmt::format("_{}", particles);
  report.add_ratio("optimum_over_paper_procedure" + suffix, ratio(times[1], times[0]));
  report.add_ratio("optimum_over_restarted_procedure" + suffix, ratio(times[2], times[0]));

  const auto on_all = interleave(std::span(runs).first(1), {repetitions, 0.02}, Clock::wall);
  report.add(fmt::format("N = {}, global search", particles), "on all cores", "ms",
             scaled(statistics(on_all[0]), 1e3));
}

/// A chain so fine that its hinges would want more than `most_steps` gets softer ones.
Problem with_few_steps(Report& report, Index particles, Index most_steps) {
  Scene scene = straight_to_s(particles);
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
  const std::string name = fmt::format("N = {}, global search", problem.chain.particles());
  const std::unique_ptr<Backend> native = native::make_backend(problem);
  const std::unique_ptr<Backend> finer = native::make_backend(problem, native->time_step() / 4);
  const Objective ours = objective(*native);
  OptimizeSummary found;
  const std::array<Run, 1> runs = {Run{[&] { return (found = global_search(ours)).error; }}};
  std::vector<std::vector<double>> times, on_all;
  {
    const OnCores one(1);
    times = interleave(runs, {repetitions, 0}, Clock::cpu);
  }
  on_all = interleave(runs, {1, 0}, Clock::wall);
  const double limit = finer->errors({&found.gain, 1}).front();
  const double off = std::abs(limit - found.error) / problem.chain.length;
  report.check(off < tolerance,
               fmt::format("{}: E at the best gain is converged to {:.0e}", name, off));
  add_optimum(report, name, native->steps(), off, statistics(times[0]), found,
              limit / problem.chain.length);
  report.add(name, "on all cores", "ms", scaled(statistics(on_all[0]), 1e3));
}

void growth(Report& report, int repetitions) {
  const Problem small_problem = make_problem(straight_to_s(32));
  const std::unique_ptr<Backend> large = native::make_backend(make_problem(straight_to_s(64)));
  const std::unique_ptr<Backend> small = native::make_backend(small_problem, large->time_step());
  report.check(small->steps() == large->steps(), "32 and 64 particles fly in the same steps");
  const Objective small_objective = objective(*small);
  const Objective large_objective = objective(*large);
  OptimizeSummary of_small, of_large;
  const std::array<Run, 2> runs = {
      Run{[&] { return (of_small = global_search(small_objective)).error; }},
      Run{[&] { return (of_large = global_search(large_objective)).error; }},
  };
  const OnCores one(1);
  const auto times = interleave(runs, {repetitions, 0.02}, Clock::cpu);
  const auto add = [&](const std::string& name, const Backend& backend,
                       const std::vector<double>& time, const OptimizeSummary& summary) {
    report.add(name, "steps", "", exactly(static_cast<double>(backend.steps())));
    report.add(name, "time", "ms", scaled(statistics(time), 1e3));
    report.add(name, "evaluations", "", exactly(static_cast<double>(summary.evaluations)));
  };
  add("same step, N = 32", *small, times[0], of_small);
  add("same step, N = 64", *large, times[1], of_large);
  report.add_ratio("growth_32_to_64", ratio(times[1], times[0]));
}

}  // namespace

void optimum(Report& report, const Options& options) {
  report.begin(
      "optimum",
      fmt::format(
          "One core, CPU time, to the best gain of straight-to-s, at the own step of the native "
          "chain.\nPaper's procedure: steepest descent from α = 0 with central differences over a "
          "plain scalar chain (explicit\nsprings, semi-implicit Euler, atan2, sqrt; launch exact "
          "for its own steps). It ends in the first valley;\nrestarted: once for every turn of "
          "the control's oscillation, until it is told that it is as low as ours.\nBoth chains "
          "keep E at 0, ½, 1 and 2 best gains within {} of the length of the limit of small "
          "steps,\nthe plain one at the longest such step.",
          tolerance));
  against_paper(report, 32, options.quick ? 9 : 25);
  against_paper(report, 64, options.quick ? 3 : 9);
  growth(report, options.quick ? 9 : 25);
  const Problem fine = make_problem(straight_to_s(128));
  alone(report, fine, options.quick ? 1 : 7);
  const Index most_steps = native::make_backend(fine)->steps() / (options.quick ? 2 : 1);
  alone(report, with_few_steps(report, 1024, most_steps), options.quick ? 1 : 3);
  report.end();
}

}  // namespace nuno::bench
