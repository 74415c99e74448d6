// Sheets: what a gain of a batch costs beside other engines' cloth, and the way to the best gain
// and to a refined answer.

#include <fmt/format.h>

#include <nuno/bullet.h>
#include <nuno/error.h>
#include <nuno/native.h>
#include <nuno/optimize.h>
#include <nuno/refine.h>
#include <nuno/rollout.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <vector>

#include "peers.h"
#include "problems.h"
#include "sections.h"

namespace nuno::bench {
namespace {

constexpr Index batch_gains = 16;  // whole batches for every instruction set

/// Gains about the one that a cloth is refined at, all of them well-conditioned.
std::vector<double> gains_near_tracking(const Backend& backend) {
  std::vector<double> gains;
  for (Index i = 0; i < batch_gains; ++i) {
    gains.push_back(tracking_gain(backend) * (0.5 + static_cast<double>(i) / batch_gains));
  }
  return gains;
}

double sum(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

/// Nanoseconds per particle and step of these times of a call.
std::vector<double> per_particle_step(std::vector<double> times, double flights, Index particles,
                                      Index steps) {
  for (double& time : times) time *= 1e9 / (flights * static_cast<double>(particles * steps));
  return times;
}

/// Both engines of ours in the same throw, each at its own step.
void compare_engines(Report& report, Index columns, const Effort& effort, const std::string& key) {
  const Problem problem = thrown_sheet(columns);
  const Index particles = problem.cloth().particles();
  const auto native = native::make_backend(problem), bullet = bullet::make_backend(problem);
  const std::vector<double> gains = gains_near_tracking(*native);
  const double fine_step = native->time_step() / 8;
  const Points exact =
      rollout(*native::make_backend(with_time_step(problem, fine_step)), gains[0]).final;
  const auto off = [&](const Backend& engine) {
    return shape_difference(rollout(engine, gains[0]).final, exact).mean / problem.cloth().size;
  };
  const double native_off = off(*native), bullet_off = off(*bullet);
  report.check(native_off < 1e-5 && bullet_off < 1e-4,
               fmt::format("{} particles: native's end shape is converged to {:.0e}, Bullet's to "
                           "{:.0e} of the size",
                           particles, native_off, bullet_off));
  bool equal = true;
  const std::vector<double> batch = native->errors(gains);
  for (std::size_t i = 0; i < gains.size(); ++i) {
    equal &= batch[i] == rollout(*native, gains[i]).error.mean;
  }
  report.check(equal, fmt::format("a batch of {} gains equals rollouts bit for bit", batch_gains));

  const std::vector<Run> runs = {
      Run{[&] { return sum(native->errors(gains)); }},
      Run{[&] { return rollout(*native, gains[0]).error.mean; }},
      Run{[&] {
        return bullet->errors({&gains[0], 1}).front();
      }},
  };
  const auto times = interleave(runs, effort, Clock::cpu);
  const auto add = [&](const std::string& name, std::size_t run, double flights, Index steps,
                       double shape_off) {
    const std::string row = fmt::format("{}, {} particles", name, particles);
    report.add(row, "steps", "", exactly(static_cast<double>(steps)));
    report.add(row, "shape off by", "size", exactly(shape_off));
    report.add(row, "a flight", "ms", scaled(statistics(times[run]), 1e3 / flights));
    report.add(row, "per particle-step", "ns",
               statistics(per_particle_step(times[run], flights, particles, steps)));
  };
  add("native, batch", 0, batch_gains, native->steps(), native_off);
  add("native, rollout", 1, 1, native->steps(), native_off);
  add("Bullet, our laws", 2, 1, bullet->steps(), bullet_off);
  report.add_ratio(key, scaled(ratio(times[2], times[0]), batch_gains));
}

/// A sheet let go at rest, as other engines' users make it.
void add_peers(Report& report, const Effort& effort) {
  constexpr Index columns = 16;
  const Problem problem = released_sheet(columns);
  const std::vector<Peer> others = sheet_peers(problem);
  std::vector<Run> runs;
  for (const Peer& peer : others) {
    const Points final = peer.fly();
    const double fall = (centroid(final) - centroid(problem.target)).norm();
    double strain = 0;
    for (Index e = 0; e < problem.cloth().edges.cols(); ++e) {
      const auto ends = problem.cloth().edges.col(e);
      const double length = (final.col(ends[1]) - final.col(ends[0])).norm();
      strain += std::abs(length / problem.cloth().rest_length[e] - 1);
    }
    strain /= static_cast<double>(problem.cloth().edges.cols());
    const double too_far = problem.cloth().gravity / static_cast<double>(peer.steps) + 0.01;
    report.check(final.allFinite() && fall < too_far && strain < 0.1,
                 fmt::format("{}: falls to {:.1e} m, keeps its edges to {:.1e} in the mean",
                             peer.name, fall, strain));
    runs.push_back({[&peer] { return peer.fly().sum(); }});
  }
  const auto times = interleave(runs, effort, Clock::cpu);
  for (std::size_t i = 0; i < others.size(); ++i) {
    report.add(others[i].name, "per particle-step", "ns",
               statistics(per_particle_step(times[i], 1, columns * columns, others[i].steps)));
  }
}

/// The best gain of one sheet; its median time.
double add_optimum(Report& report, const std::string& name, const Problem& problem,
                   int repetitions) {
  const auto native = native::make_backend(problem);
  const Objective errors = objective(*native);
  const OptimizeSummary found = global_search(errors);
  report.check(found.error < 1e-3 * problem.cloth().size,
               fmt::format("{}: the best gain comes to {:.1e} of the size", name,
                           found.error / problem.cloth().size));
  const std::vector<Run> runs = {Run{[&] { return global_search(errors).error; }}};
  const auto times = interleave(runs, {repetitions, 0}, Clock::cpu);
  report.add(name, "steps", "", exactly(static_cast<double>(native->steps())));
  report.add(name, "best gain", "s", statistics(times[0]));
  return statistics(times[0]).median;
}

/// A refined answer of one sheet, in flights' time.
void add_refinement(Report& report, const std::string& name, const Problem& problem,
                    int repetitions) {
  const auto native = native::make_backend(problem);
  const double gain = tracking_gain(*native);
  const auto refined = [&] {
    return refine(problem, gain, native::make_backend, native::make_backend).flight.error.mean;
  };
  const double error = refined() / problem.cloth().size;
  report.check(error <= 1e-6, fmt::format("{}: refined to {:.1e} of the size", name, error));
  const std::vector<Run> runs = {Run{refined},
                                 Run{[&] { return rollout(*native, gain).error.mean; }}};
  const auto times = interleave(runs, {repetitions, 0}, Clock::cpu);
  report.add(name, "refined", "rollouts", ratio(times[0], times[1]));
}

}  // namespace

void sheet_throughput(Report& report, const Options& options) {
  report.begin("sheet throughput",
               fmt::format("One core, CPU time. A flat square is thrown into an S under damped "
                           "morph, each engine at its own step;\nnative batch: {} gains a call, "
                           "per gain. Below, a square let go as an S, by other engines' own cloth.",
                           batch_gains));
  const OnCores one(1);
  const Effort effort{options.quick ? 5 : 15, 0.02};
  compare_engines(report, 16, effort, "sheet_batch_over_bullet");
  if (!options.quick) compare_engines(report, 32, effort, "sheet_batch_over_bullet_1024");
  add_peers(report, effort);
  report.end();
}

void sheet_optimum(Report& report, const Options& options) {
  report.begin(
      "sheet optimum",
      "One core, CPU time. The best gain of a flat square thrown into an S, and the answer "
      "refined from the gain of tracking.\nS is the stretch stiffness.");
  const OnCores one(1);
  const std::vector<Index> sizes =
      options.quick ? std::vector<Index>{16, 32} : std::vector<Index>{16, 32, 64};
  std::vector<double> soft_times;
  for (const double stiffness : {500.0, 4000.0}) {
    for (std::size_t k = 0; k < sizes.size(); ++k) {
      const Problem problem = thrown_sheet(sizes[k], stiffness);
      const std::string name =
          fmt::format("{} particles, S = {} N/m", sizes[k] * sizes[k], stiffness);
      const int repetitions = options.quick || sizes[k] == 64 ? 1 : 5;
      const double time = add_optimum(report, name, problem, repetitions);
      if (stiffness == 500) {
        add_refinement(report, name, problem, repetitions);
        soft_times.push_back(time);
      }
      const double over_soft = time / soft_times[k];
      if (stiffness > 500) report.add(name, "over S = 500 N/m", "×", exactly(over_soft));
    }
  }
  report.end();
  for (std::size_t k = 1; k < soft_times.size(); ++k) {
    report.add_ratio(
        fmt::format("sheet_optimum_{}_over_{}", sizes[k] * sizes[k], sizes[k - 1] * sizes[k - 1]),
        exactly(soft_times[k] / soft_times[k - 1]));
  }
}

}  // namespace nuno::bench
