#include "step_choice.h"

#include <nuno/backend.h>
#include <nuno/launch.h>
#include <nuno/scene.h>

#include <fmt/format.h>

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
// More steps cost centroid: its rounding grows with their number, 5e-5 of the cloth's length at
// t₀/2000, 2e-4 at t₀/4000, 4e-4 at t₀/8000 (s-curve without control, where it is largest).
// The seeded family asks for 1e-3 and 5e-3: t₀/1000 and 8 iterations leave a margin of five, at a
// third of the time of t₀/2000 and 16 (docs/two-engines.md).
constexpr double default_steps = 1000;

/// A step that the engine can take, and what asked for it.
struct StepLimit {
  double h = 0;  // [s]
  const char* field = "";
  double value = 0;
};

/// The hinges' springs are explicit, of highest frequency ω² = 16·k/(m·ℓ²) for a moment k·θ on
/// particles of a straight chain, and their dashpots of rate c in its place. h²ω² + 2hc ≤ ½ stays
/// well below RATTLE's own limit of 4, since λ̄ lags: on the scenes above at t₀/1000 the 95th
/// percentile of the gap is 3e-4, with 1 in place of ½ 1.5e-3, with 2 5.6e-3.
StepLimit hinge_limit(const Chain& chain) {
  constexpr double limit = 0.5;
  const double shortest = chain.rest_length.minCoeff();
  const double per_hinge =
      16 / (chain.hinge_length.minCoeff() * shortest * shortest * chain.particle_mass);
  const double squared_frequency = per_hinge * chain.material.hinge_stiffness;
  const double rate = per_hinge * chain.material.hinge_damping;
  if (chain.material.hinge_stiffness == 0 && chain.material.hinge_damping == 0) {
    return {std::numeric_limits<double>::infinity(), "", 0};
  }
  const double h = limit / (rate + std::sqrt(rate * rate + limit * squared_frequency));
  if (rate * rate > squared_frequency)
    return {h, "/cloth/hinge_damping", chain.material.hinge_damping};
  return {h, "/cloth/hinge_stiffness", chain.material.hinge_stiffness};
}

/// A free flight by no more than a rod per step, half of Box2D's limit.
StepLimit flight_limit(const Problem& problem) {
  const Chain& chain = problem.chain();
  const double rod = chain.size / static_cast<double>(chain.particles() - 1);
  const Points launch = ballistic_launch(chain.initial, problem.target, problem.arrival_time,
                                         chain.gravity, chain.drag_rate);
  const double fastest = launch.colwise().norm().maxCoeff() + chain.gravity * problem.arrival_time;
  return {rod / fastest, "/arrival_time", problem.arrival_time};
}

StepLimit drag_limit(const Chain& chain) {
  return {0.25 / chain.drag_rate, "/cloth/air_drag", chain.material.air_drag};
}

}  // namespace

Index count_steps(const Problem& problem) {
  StepLimit tightest{problem.arrival_time / default_steps, "/arrival_time", problem.arrival_time};
  if (problem.time_step) tightest = {*problem.time_step, "/time_step", *problem.time_step};
  if (!(tightest.h > 0)) {
    throw InputError(fmt::format("/time_step: {} is not > 0", tightest.value));
  }
  for (const StepLimit& limit :
       {hinge_limit(problem.chain()), flight_limit(problem), drag_limit(problem.chain())}) {
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
