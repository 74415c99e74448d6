#include <fmt/format.h>

#include <nuno/box2d.h>
#include <nuno/error.h>
#include <nuno/native.h>
#include <nuno/rollout.h>

#include <cmath>
#include <memory>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "instruction_sets.h"
#include "peers.h"
#include "problems.h"
#include "sections.h"

namespace nuno::bench {
namespace {

constexpr Index particles = 32;
constexpr Index steps = 1000;
constexpr Index batch_gains = 64;  // whole batches for every instruction set

double sum(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

void check_native(Report& report, const Backend& native, std::span<const double> gains,
                  std::span<const InstructionSet> sets) {
  const double length = native.problem().cloth().size;
  std::vector<double> first;
  for (const InstructionSet& set : sets) {
    use(set);
    const std::vector<double> batch = native.errors(gains);
    bool equal = true;
    for (std::size_t i = 0; i < gains.size(); ++i) {
      equal &= batch[i] == native.errors(gains.subspan(i, 1)).front();
    }
    report.check(equal, fmt::format("{}: a batch of {} gains equals the scalar chain bit for bit",
                                    set.name, gains.size()));
    if (first.empty()) first = batch;
    double apart = 0;
    for (std::size_t i = 0; i < gains.size(); ++i) {
      apart = std::max(apart, std::abs(batch[i] - first[i]) / length);
    }
    report.check(apart < 1e-8, fmt::format("{}: its errors are {}'s, to {:.0e} of the length",
                                           set.name, sets.front().name, apart));
  }
  use(sets.front());
}

/// How far a flight is from what every chain that is let go must do.
struct Plausibility {
  double centroid = 0;  ///< from where it must fall to [m]
  double stretch = 0;   ///< of the whole chain, of its length
  double shape = 0;     ///< from the native chain's, mean over the length
};

Plausibility plausibility(const Problem& problem, const Points& final, const Points& native) {
  Plausibility result;
  result.centroid = (centroid(final) - centroid(problem.target)).norm();
  result.stretch = std::abs(segment_lengths(final).sum() / problem.cloth().size - 1);
  result.shape = shape_difference(final, native).mean / problem.cloth().size;
  return result;
}

void check_flight(Report& report, const Problem& problem, const std::string& name,
                  const Points& final, const Points& native, double shape_tolerance) {
  const Plausibility found = plausibility(problem, final, native);
  // An Euler scheme of first order falls g·t₀·h/2 too far; twice that, and single precision.
  const double h = problem.arrival_time / static_cast<double>(steps);
  const double centroid_tolerance =
      problem.cloth().gravity * problem.arrival_time * h + 1e-3 * problem.cloth().size;
  report.check(final.allFinite() && found.centroid < centroid_tolerance && found.stretch < 0.02 &&
                   found.shape <= shape_tolerance,
               fmt::format("{}: falls to {:.1e} m, keeps its length to {:.1e}, has the native "
                           "chain's shape to {:.1e} of the length",
                           name, found.centroid, found.stretch, found.shape));
  report.add(name, "shape off by", "length", exactly(found.shape));
  report.add(name, "length off by", "1", exactly(found.stretch));
}

/// What is measured: a call flies so many chains.
struct Contestants {
  std::vector<std::string> names;
  std::vector<double> chains;
  std::vector<Run> runs;

  void add(const std::string& name, double chains_per_call, Run run) {
    names.push_back(name);
    chains.push_back(chains_per_call);
    runs.push_back(std::move(run));
  }
};

constexpr std::size_t batch = 1;  // the contestant after the scalar chain, which is the first

void add_native(Contestants& contestants, const std::string& scalar_name, const Backend& native,
                const std::vector<double>& gains, const std::vector<InstructionSet>& sets) {
  const auto use_best = [&set = sets.front()] { use(set); };
  contestants.add(scalar_name, 1,
                  {[&] {
                     return native.errors({&gains[1], 1}).front();
                   },
                   use_best});
  for (const InstructionSet& set : sets) {
    contestants.add(fmt::format("native, batch ({})", set.name), static_cast<double>(gains.size()),
                    {[&] { return sum(native.errors(gains)); }, [&set] { use(set); }});
  }
}

/// Our chain on Box2D with either of its hinges; gives the first of the two.
std::size_t add_box2d(Contestants& contestants, Report& report, const Problem& problem,
                      const Points& exact, double gain) {
  const double h = problem.arrival_time / static_cast<double>(steps);
  const std::size_t first = contestants.runs.size();
  for (const box2d::Hinge hinge : {box2d::Hinge::soft_weld, box2d::Hinge::spring_pair}) {
    const std::shared_ptr<const Backend> backend =
        box2d::make_backend_with({.hinge = hinge}, with_time_step(problem, h));
    const std::string name = fmt::format(
        "Box2D chain, {}",
        hinge == box2d::Hinge::soft_weld ? "soft welds" : "revolute joints and spring pairs");
    report.check(backend->steps() == steps, "the Box2D chain takes the same steps");
    check_flight(report, problem, name, rollout(*backend, 0).final, exact, 0.05);
    contestants.add(name, 1, {[backend, gain] { return backend->errors({&gain, 1}).front(); }});
  }
  return first;
}

/// Chains as other engines' users write them; gives the first.
std::size_t add_peers(Contestants& contestants, Report& report, const Problem& problem,
                      const Points& exact, const std::vector<Peer>& peers) {
  const std::size_t first = contestants.runs.size();
  for (const Peer& peer : peers) {
    check_flight(report, problem, peer.name, peer.fly(), exact, peer.shape_tolerance);
    contestants.add(peer.name, 1, {[&peer] { return peer.fly().sum(); }});
  }
  return first;
}

/// Seconds per call to nanoseconds per particle and step.
std::vector<std::vector<double>> per_particle_step(std::vector<std::vector<double>> times,
                                                   const Contestants& contestants) {
  for (std::size_t i = 0; i < times.size(); ++i) {
    const double work = static_cast<double>(steps * particles) * contestants.chains[i];
    for (double& value : times[i]) value *= 1e9 / work;
  }
  return times;
}

}  // namespace

void throughput(Report& report, const Options& options) {
  report.begin("throughput",
               fmt::format("One core, CPU time. An S-curve of {} particles is let go and falls for "
                           "1 s in {} steps.\nOne chain a flight; native batch: {} gains a call, "
                           "per gain. Native and Box2D also apply shape control.",
                           particles, steps, batch_gains));
  const OnCores one(1);
  const Problem problem = release(particles);
  const double h = problem.arrival_time / static_cast<double>(steps);
  const std::unique_ptr<Backend> native = native::make_backend(with_time_step(problem, h));
  report.check(native->steps() == steps, "the native chain takes the same steps");
  const double scale =
      problem.cloth().particle_mass / (problem.arrival_time * problem.arrival_time);
  const std::vector<double> gains = spread_gains(scale, batch_gains);
  const std::vector<InstructionSet> sets = instruction_sets();
  check_native(report, *native, gains, sets);

  const Points ours = rollout(*native, 0).final;
  const Points exact = rollout(*native::make_backend(with_time_step(problem, h / 16)), 0).final;
  const std::string scalar_name = fmt::format("native, scalar ({})", sets.front().name);
  check_flight(report, problem, scalar_name, ours, exact, 1e-3);

  Contestants contestants;
  add_native(contestants, scalar_name, *native, gains, sets);
  const std::size_t first_box2d = add_box2d(contestants, report, problem, exact, gains[1]);
  const std::vector<Peer> others = peers(problem, steps);
  const std::size_t first_peer = add_peers(contestants, report, problem, exact, others);

  const Effort effort{options.quick ? 9 : 25, 0.008};
  const auto times = interleave(contestants.runs, effort, Clock::cpu);
  use(sets.front());
  const auto per_step = per_particle_step(times, contestants);
  for (std::size_t i = 0; i < per_step.size(); ++i) {
    report.add(contestants.names[i], "per particle-step", "ns", statistics(per_step[i]));
    report.add(contestants.names[i], "batch faster by", "×", ratio(per_step[i], per_step[batch]));
  }
  report.end();

  // Against the faster of Box2D's two hinges, and of b2Rope's two models at its usual iterations.
  const auto over_faster_of = [&](std::size_t run) {
    const Statistics a = ratio(per_step[run], per_step[batch]);
    const Statistics b = ratio(per_step[run + 1], per_step[batch]);
    return a.median < b.median ? a : b;
  };
  report.add_ratio("batch_over_b2rope", over_faster_of(first_peer));
  report.add_ratio("batch_over_b2rope_1_iteration",
                   ratio(per_step[first_peer + 2], per_step[batch]));
  report.add_ratio("batch_over_box2d", over_faster_of(first_box2d));
}

}  // namespace nuno::bench
