#include <fmt/format.h>

#include <nuno/native.h>
#include <nuno/rollout.h>

#include <cmath>
#include <memory>
#include <numbers>

#include "problems.h"
#include "sections.h"

namespace nuno::bench {
namespace {

/// A ribbon of the segments that straight-to-s has with 32 particles, but of very many: each as
/// long, as heavy and as stiff. It lies straight and shall arrive in gentle waves.
ChainScene ribbon(Index particles) {
  ChainScene scene = straight_to_s(32);
  const double segments = static_cast<double>(particles - 1);
  const double length = segments / 31;
  const double share = static_cast<double>(particles) / 32;
  scene.name = "ribbon";
  scene.particles = particles;
  scene.cloth.mass *= share;
  scene.cloth.air_drag *= share;
  scene.initial.resize(2, 2);
  scene.initial << 0, length, 0, 0;
  const Index points = 1 + static_cast<Index>(std::ceil(length));
  scene.target.resize(2, points);
  for (Index i = 0; i < points; ++i) {
    const double along = length * static_cast<double>(i) / static_cast<double>(points - 1);
    scene.target.col(i) << along + 3, std::sin(2 * std::numbers::pi * along / 50);
  }
  return scene;
}

}  // namespace

void long_rollout(Report& report, const Options&) {
  constexpr Index particles = 100'000;
  constexpr Index steps = 1000;
  report.begin("long rollout",
               fmt::format("{} particles, {} steps of 1 ms, one gain, one core, 60 frames kept. "
                           "Memory: the process's peak above what\nit had before, without the "
                           "frames; `ready`: scene, problem and engine; `all`: those and the "
                           "rollout.",
                           particles, steps));
  const OnCores one(1);
  const double before = memory_in_use();
  reset_peak_memory();
  Problem problem = make_problem(ribbon(particles));
  const double h = problem.arrival_time / static_cast<double>(steps);
  const double gain = problem.cloth().particle_mass / (problem.arrival_time * problem.arrival_time);
  const std::unique_ptr<Backend> native = native::make_backend(with_time_step(problem, h));
  problem = {};
  const double peak_ready = peak_memory();
  const double ready = memory_in_use();
  reset_peak_memory();
  const double start = seconds(Clock::cpu);
  const Rollout flight = rollout(*native, gain, {.frames_per_second = 60});
  const double time = seconds(Clock::cpu) - start;
  const double peak = peak_memory();

  const Chain& chain = native->problem().chain();
  double frames = 0;
  for (const Points& frame : flight.frame_positions) {
    frames += static_cast<double>(frame.size()) * sizeof(double);
  }
  report.check(native->steps() == steps, "it takes these steps");
  report.check(flight.status == RolloutStatus::ok && flight.error.centroid < 1e-9 * chain.size,
               fmt::format("its centroid arrives to {:.0e} of the length",
                           flight.error.centroid / chain.size));
  const double stretch =
      (segment_lengths(flight.final).array() / chain.rest_length.array() - 1).abs().maxCoeff();
  report.check(stretch < 0.05,
               fmt::format("no segment has stretched by more than {:.0e}", stretch));
  report.check(flight.error.mean < 1, fmt::format("it arrives within {:.2f} m, in waves of ±1 m "
                                                  "over {:.0f} m",
                                                  flight.error.mean, chain.size));

  const std::string name = fmt::format("N = {}", particles);
  const double n = static_cast<double>(particles);
  report.add(name, "time", "s", exactly(time));
  report.add(name, "per particle-step", "ns",
             exactly(1e9 * time / (n * static_cast<double>(steps))));
  report.add(name, "frames", "MB", exactly(1e-6 * frames));
  report.add(name, "ready, peak", "bytes/particle", exactly((peak_ready - before) / n));
  report.add(name, "ready", "bytes/particle", exactly((ready - before) / n));
  report.add(name, "rollout alone", "bytes/particle", exactly((peak - ready - frames) / n));
  report.add(name, "all", "bytes/particle", exactly((peak - before - frames) / n));
  report.end();
}

}  // namespace nuno::bench
