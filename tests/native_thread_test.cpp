// A stretched thread rings and dies away as the oscillator that it is.

#include <nuno/native.h>

#include <gtest/gtest.h>

#include <cmath>

#include "bare_problem.h"

namespace nuno {
namespace {

/// Stretch of either half of a straight chain of three, whose ends part at 1 m/s, after 20 ms in
/// steps of h. The middle stays, so each end hangs on a spring k and a dashpot c of its own.
double stretch_after(double h, const ChainMaterial& cloth) {
  Problem problem = problem_of(Points{{-0.5, 0, 0.5}, {0, 0, 0}}, 0, cloth);
  problem.arrival_time = 0.02;
  const auto backend = native::make_backend(with_time_step(problem, h));
  const auto chain = backend->start(Points{{-1, 0, 1}, {0, 0, 0}});
  for (Index n = 0; n < backend->steps(); ++n) chain->step(Points::Zero(2, 3));
  return chain->positions()(0, 2) - 0.5;
}

// With ω² = k/m and γ = c/2m, u(t) = e^(−γt)·sin(ω't)/ω', ω'² = ω² − γ².
TEST(NativeThread, RingsAndDiesAwayByItsDashpot) {
  const double mass = 0.1 / 3, length = 0.5;
  for (const double damping : {0.0, 0.3, 1.5}) {  // ηA [N·s]: γ/ω = 0, 0.08, 0.4
    const ChainMaterial cloth = {.air_drag = 0, .stretch_damping = damping, .hinge_stiffness = 0};
    const double omega2 = cloth.stretch_stiffness / length / mass;
    const double gamma = damping / length / mass / 2;
    const double rate = std::sqrt(omega2 - gamma * gamma);
    const double exact = std::exp(-gamma * 0.02) * std::sin(rate * 0.02) / rate;
    const double coarse = stretch_after(1e-4, cloth) - exact;
    const double fine = stretch_after(0.5e-4, cloth) - exact;
    // Of second order: (ωh)² is 1e-4 of the amplitude 1/ω, and a quarter of that.
    EXPECT_LT(std::abs(coarse), 1e-4 / std::sqrt(omega2)) << damping;
    EXPECT_NEAR(coarse / fine, 4, 0.2) << damping;
  }
}

}  // namespace
}  // namespace nuno
