#include "step_choice.h"

#include <nuno/backend.h>
#include <nuno/launch.h>
#include <nuno/scene.h>

#include <fmt/format.h>

#include "rod_chain.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace nuno::box2d {
namespace {

// The gap of the end shapes to the native chain at a 4e-5 s step, at the native best gain, over the
// cloth's length: median and 95th percentile of the 27 of 60 random scenes (32 particles, t₀ of 0.4
// to 2 s, three decades of hinge stiffness) where a perturbation grows less than tenfold; and the
// time of one flight:
//     iterations         8                        16                       32
//     t₀/1000   6.9e-5, 4.9e-4, 14 ms    5.9e-5, 3.1e-4, 20 ms    6.1e-5, 3.9e-4,  31 ms
//     t₀/2000   3.5e-5, 4.9e-4, 31 ms    3.5e-5, 3.1e-4, 41 ms    3.6e-5, 3.9e-4,  63 ms
//     t₀/4000   1.8e-5, 4.9e-4, 61 ms    2.6e-5, 2.4e-4, 74 ms    4.2e-5, 3.1e-4, 108 ms
// 60 scenes that had no say in any choice here give 6.0e-5, 4.9e-4 at t₀/2000 and 16 iterations.
// The seeded family asks for 1e-3 and 5e-3: t₀/1000 and 8 iterations leave a margin of five, at a
// third of the time of t₀/2000 and 16 (docs/two-engines.md).
// All that is of explicit hinges, at h²ω² ≤ ½. Implicit ones take t₀/1000 where those took up to
// t₀/6000; median, 95th percentile and worst of 45 scenes of the family go from 1.4e-4, 1.0e-3,
// 1.9e-3 to 2.2e-4, 1.8e-3, 2.7e-3: the waves of stiff cloth, which swing a hundred times, are out
// of phase.
constexpr double default_steps = 1000;

/// A step that the engine can take, and what asked for it.
struct StepLimit {
  double h = 0;  // [s]
  const char* field = "";
  double value = 0;
};

/// Soft welds are implicit and stable at any step: iterations solve for them or, where dashpots are
/// too rigid, joint_impulses.h. So dashpots ask for nothing. Springs swing: at h²ω² = 600 the waves
/// of the whole cloth still take tens of steps.
///
/// A pair of springs also feels how far its joint is open, and the joint's impulse against that
/// lags behind (λ̄): it bursts from 2 on.
StepLimit hinge_limit(const Chain& chain, Hinge form) {
  const bool is_weld = form == Hinge::soft_weld;
  const double limit = is_weld ? 600 : 0.5;
  auto [squared_frequency, rate] = hinge_rates(chain);
  if (is_weld) rate = 0;
  if (squared_frequency == 0 && rate == 0) return {std::numeric_limits<double>::infinity(), "", 0};
  const double h = 2 * limit / (rate + std::sqrt(rate * rate + 4 * limit * squared_frequency));
  if (rate > h * squared_frequency)
    return {h, "/cloth/hinge_damping", chain.material.hinge_damping};
  return {h, "/cloth/hinge_stiffness", chain.material.hinge_stiffness};
}

/// A launch about the mass centre by no more than a rod per step, half of Box2D's limit.
StepLimit flight_limit(const Problem& problem) {
  const Chain& chain = problem.chain();
  const double rod = chain.size / static_cast<double>(chain.particles() - 1);
  const Points launch = ballistic_launch(chain.initial, problem.target, problem.arrival_time,
                                         chain.gravity, chain.drag_rate);
  const double fastest = shape_of(launch).colwise().norm().maxCoeff();
  return {rod / fastest, "/arrival_time", problem.arrival_time};
}

StepLimit drag_limit(const Chain& chain) {
  return {0.25 / chain.drag_rate, "/cloth/air_drag", chain.material.air_drag};
}

}  // namespace

Index count_steps(const Problem& problem, Hinge form) {
  StepLimit tightest{problem.arrival_time / default_steps, "/arrival_time", problem.arrival_time};
  if (problem.time_step) tightest = {*problem.time_step, "/time_step", *problem.time_step};
  if (!(tightest.h > 0)) {
    throw InputError(fmt::format("/time_step: {} is not > 0", tightest.value));
  }
  for (const StepLimit& limit :
       {hinge_limit(problem.chain(), form), flight_limit(problem), drag_limit(problem.chain())}) {
    if (!(tightest.h <= limit.h)) tightest = limit;
  }
  const double steps = std::ceil(problem.arrival_time / tightest.h * (1 - 1e-12));
  if (!(steps <= most_steps)) {
    throw InputError(fmt::format("{}: {} takes {:.3g} steps on box2d, which is not <= {:.0f}",
                                 tightest.field, tightest.value, steps, most_steps));
  }
  return std::max<Index>(1, static_cast<Index>(steps));
}

}  // namespace nuno::box2d
