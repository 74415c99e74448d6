#include "chain_steps.h"

#include <nuno/backend.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace nuno::native {
namespace {

/// Steps that a flight needs, and the field that asks for them, with its value.
struct Wish {
  double steps = 0;
  const char* field = "";
  double value = 0;
};

/// Explicit hinges. With ω their highest frequency and c their highest damping rate, the leapfrog
/// with lagging dashpots is stable where h²ω² + 2hc < 4. A hinge's energy ½·kθ² has the largest
/// curvature 16·k/ℓ² over the particles of a straight chain.
///
/// A quarter of the stable step leaves room for hinges that stiffen where segments are compressed:
/// at half of it, one of the 64 scenes of the library's family diverges at some gains, here none.
Wish stable_steps(const Problem& problem) {
  constexpr double safety = 0.25;
  const Chain& chain = problem.chain();
  const double shortest = chain.rest_length.minCoeff();
  const double per_hinge =
      16 / (chain.hinge_length.minCoeff() * shortest * shortest * chain.particle_mass);
  const double squared_frequency = per_hinge * chain.material.hinge_stiffness;
  const double rate = per_hinge * chain.material.hinge_damping;
  // h = 4/(c + √(c² + 4ω²)), the root of h²ω² + 2hc = 4.
  const double h = safety * 4 / (rate + std::sqrt(rate * rate + 4 * squared_frequency));
  if (rate * rate > 4 * squared_frequency) {
    return {problem.arrival_time / h, "/cloth/hinge_damping", chain.material.hinge_damping};
  }
  return {problem.arrival_time / h, "/cloth/hinge_stiffness", chain.material.hinge_stiffness};
}

/// Implicit hinges are stable at any step, so the motion alone decides.
///
/// The throw, the control and the reference take t₀ for their way: 1000 steps give E(α) of the S to
/// 2e-5 of L with 64 to 1000 particles. A ballistic launch also sets off waves along the thread,
/// which 1600 steps resolve so far that E is within 1e-4 L; 800, within 4e-4.
///
/// Stiff cloth swings on its way. A wave of frequency ω that the launch sets off has an amplitude
/// of about L/(ω·t₀), and its phase at arrival is ω·t₀·(ωh)²/12 or so off: 1/12 (ωh)² of L
/// altogether. h = 0.05/ω for the third bending wave of the whole cloth, ω = 121·√(EI/(M·L³)),
/// makes that 2e-4 of L at most; beyond ω·t₀ = 1000 the amplitude itself is small. With half of all
/// these steps the best flights of the library's family are off by 2e-3 L at worst.
Wish motion_steps(const Problem& problem) {
  const Chain& chain = problem.chain();
  const double mass = chain.particle_mass * static_cast<double>(chain.particles());
  const double third_wave =
      121 * std::sqrt(chain.material.hinge_stiffness / (mass * std::pow(chain.size, 3)));
  const double swings = std::min(third_wave * problem.arrival_time, 1000.0);
  return {std::max(problem.launch == Launch::ballistic ? 1600.0 : 1000.0, 20 * swings),
          "/cloth/hinge_stiffness", chain.material.hinge_stiffness};
}

}  // namespace

ChainSteps choose_chain_steps(const Problem& problem) {
  // 1/800 of the flight keeps E(α) within 5e-4 of the cloth's length on the reference scenes.
  constexpr double default_steps = 800;
  // A step with implicit hinges costs 1.7 explicit ones, with derivatives 2.1: they pay where steps
  // are so many times fewer.
  constexpr double worthwhile = 2.5;

  Wish asked{default_steps, "/arrival_time", problem.arrival_time};
  if (problem.time_step) {
    asked = {problem.arrival_time / *problem.time_step, "/time_step", *problem.time_step};
  }
  if (!(asked.steps < std::numeric_limits<double>::infinity()) || !(asked.steps > 0)) {
    throw InputError(fmt::format("/time_step: {} is not > 0", *problem.time_step));
  }
  const auto larger = [](const Wish& a, const Wish& b) { return a.steps < b.steps ? b : a; };
  const Wish explicit_wish = larger(asked, stable_steps(problem));
  const Wish implicit_wish =
      problem.time_step ? larger(asked, motion_steps(problem)) : motion_steps(problem);
  const bool implicit_hinges = explicit_wish.steps > worthwhile * implicit_wish.steps;
  const Wish& wish = implicit_hinges ? implicit_wish : explicit_wish;
  const double steps = std::ceil(wish.steps * (1 - 1e-12));
  if (!(steps <= most_steps)) {
    throw InputError(fmt::format("{}: {} takes {:.3g} steps on native, which is not <= {:.0f}",
                                 wish.field, wish.value, steps, most_steps));
  }
  return {std::max<Index>(static_cast<Index>(steps), 1), implicit_hinges};
}

}  // namespace nuno::native
