#include <nuno/box2d.h>

#include <nuno/scene.h>

#include <fmt/format.h>

#include "chain_simulation.h"
#include "rod_chain.h"
#include "step_choice.h"

#include <cassert>
#include <cmath>

namespace nuno::box2d {
namespace {

using Eigen::Vector2d;

constexpr Index most_particles = 4096;
constexpr double shortest_rod = 1e-3;  // of the mean rod

class ChainBackend final : public Backend {
 public:
  ChainBackend(const Problem& problem, const Options& options, Index steps)
      : Backend("box2d", problem, steps),
        chain_(make_rod_chain(problem, options.hinge, steps)),
        scheme_(make_scheme(chain_, options)) {}

 private:
  // v = s·u − q·g and u' = s·(v − q·g).
  DragRecurrence do_drag_recurrence() const override {
    const double s = scheme_.keep;
    const double q = scheme_.half_kick * chain_.h;
    return {chain_.h, s, q, s * s, 2 * s * q};
  }

  std::unique_ptr<Simulation> do_start(const Points& positions,
                                       const Points& velocities) const override {
    return make_simulation(chain_, scheme_, MassCenterFlight(*this, positions, velocities),
                           positions, velocities);
  }

  // A hundred times the rounding that a flight collects in single precision.
  double do_smallest_perturbation() const override { return 1e-4; }

  RodChain chain_;
  Scheme scheme_;
};

void require_within_range(const Chain& chain, Hinge form) {
  if (chain.particles() > most_particles) {
    throw InputError(fmt::format("/particles: {} is not <= {}, the longest chain on box2d",
                                 chain.particles(), most_particles));
  }
  const double relative = chain.rest_length.minCoeff() / chain.rest_length.mean();
  if (!(relative >= shortest_rod)) {
    throw InputError(
        fmt::format("/initial: a segment of {:.2g} of the mean length is not >= {}, the shortest "
                    "rod on box2d",
                    relative, shortest_rod));
  }
  if (form != Hinge::spring_pair) return;
  for (Index i = 0; i + 2 < chain.particles(); ++i) {
    const Vector2d before = chain.initial.col(i + 1) - chain.initial.col(i);
    const Vector2d after = chain.initial.col(i + 2) - chain.initial.col(i + 1);
    const double angle = std::abs(turning_angle(before, after));
    if (!(angle <= pair_range)) {
      throw InputError(fmt::format(
          "/initial: a turning angle of {:.3g} rad at particle {} is not <= {}, the range of the "
          "spring pair on box2d",
          angle, i + 1, pair_range));
    }
  }
}

}  // namespace

std::unique_ptr<Backend> make_backend_with(const Options& options, const Problem& problem) {
  assert(options.velocity_iterations > 0 && options.position_iterations > 0);
  require_within_range(problem.chain(), options.hinge);
  return std::make_unique<ChainBackend>(problem, options, count_steps(problem, options.hinge));
}

std::unique_ptr<Backend> make_backend(const Problem& problem) {
  return make_backend_with({}, problem);
}

}  // namespace nuno::box2d
