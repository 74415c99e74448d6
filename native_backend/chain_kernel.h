#pragma once

#include <nuno/reference_motion.h>

#include "rollout_gains.h"

#include <span>
#include <string>
#include <vector>

namespace nuno::native {

/// The constants of one chain in the scheme of chain_step-inl.h or, with implicit hinges, of
/// implicit_hinges-inl.h, the same for every gain.
struct ChainPlan {
  Index particles = 0;
  Index steps = 0;
  double h = 0;                         ///< time step [s]
  std::span<const double> rest_length;  ///< ℓ [N − 1], the chain's own
  bool implicit_hinges = false;
  std::span<const double> hinge_length;  ///< ℓ̄ [N − 2], the chain's own
  std::vector<double> hinge_spring;   ///< EI/ℓ̄ of the hinge at each particle, 0 at the ends [N]
  std::vector<double> hinge_dashpot;  ///< ηI/ℓ̄ [N]; empty where the hinges have no damping
  double particle_mass = 0;           ///< m [kg]
  double damping_ratio = 0;           ///< ζ of the control force

  /// One kick of the velocities: v' = keep·v − (0, fall) + force·(forces).
  struct Kick {
    double keep = 0;          ///< r [1]
    double fall = 0;          ///< q·g [m/s]
    double force = 0;         ///< p = q/m [s/kg]
    double strain = 0;        ///< EA/c⁺, see chain_step-inl.h
    double rate = 0;          ///< c⁻/c⁺
    double compliance = 0;    ///< 1/(c⁺·p) [1/m]
    double hinge_strain = 0;  ///< the same of implicit hinges: EI/c⁺, c⁺ of a hinge times ℓ̄
    double hinge_rate = 0;
    double hinge_compliance = 0;  ///< [1/m³]
  };
  Kick first;  ///< from rest to half a step
  Kick full;
};

/// A state is two arrays [2N], x and y of a particle side by side, like Points.
struct ScalarScratch {
  explicit ScalarScratch(const ChainPlan& plan)
      : values(static_cast<std::size_t>((plan.implicit_hinges ? 12 : 4) * plan.particles)) {}
  std::vector<double> values;
};

/// Advances one chain by one step under the forces [2N].
void step(const ChainPlan& plan, bool first, const double* forces, double* positions,
          double* velocities, ScalarScratch& scratch);

/// One whole flight under shape control towards `reference` for each of `gains`: final positions
/// [2N] after another in `finals`, and their derivatives with respect to a gain in `derivatives`
/// unless that is null. Equal, bit for bit, to steps of `step` under ShapeControl.
void fly(const ChainPlan& plan, const ReferenceMotion& reference, const double* initial,
         const double* launch_velocity, const RolloutGains& gains, double* finals,
         double* derivatives);

/// A flight on its way, before a step.
struct RolloutState {
  Index step = 0;
  ReferenceMotion reference;
  Points positions;
  Points velocities;
};

/// Directions to change a flight in, one after another.
struct Directions {
  Index count = 0;
  const double* shapes = nullptr;    ///< of the reference correction [2N] each
  const Index* powers = nullptr;     ///< which of correction_powers they are for
  const double* launches = nullptr;  ///< what they make of the velocity at the start [2N] each
};

/// Derivatives that fly_along writes, of each direction after another.
struct DirectionalDerivatives {
  double* arrival = nullptr;  ///< of the final positions [2N] each
  double* forces = nullptr;   ///< of the control forces at the samples [2N × samples] each
};

/// The derivatives, along at most derivative_lanes() directions, of the rest of a flight at one
/// gain, which they do not touch before `start`. `samples` are the steps, ascending, whose control
/// forces are asked for; of those before the start nothing is written.
void fly_along(const ChainPlan& plan, const RolloutState& start, double gain,
               const Directions& directions, std::span<const Index> samples,
               const DirectionalDerivatives& derivatives);

/// Gains that `fly` takes side by side, one a SIMD lane.
Index lanes();

/// Directions that `fly_along` takes side by side.
Index derivative_lanes();

/// The instruction set in use, for people.
std::string instruction_set();

}  // namespace nuno::native
