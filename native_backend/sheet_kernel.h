#pragma once

#include <nuno/problem.h>
#include <nuno/reference_motion.h>

#include "rollout_gains.h"

#include <vector>

namespace nuno::native {

/// The constants of one sheet in the scheme of sheet_step-inl.h, the same for every gain.
/// Particles, springs and hinges are in an order of the plan's own, in which neighbours are near
/// each other in memory.
struct SheetPlan {
  Index particles = 0;
  Index steps = 0;
  Index substeps = 1;    ///< of the springs, in each step
  double time_step = 0;  ///< H [s]
  double substep = 0;    ///< h = H/substeps [s], of the springs

  std::vector<Index> user_index;           ///< of each particle in the problem [N]
  std::vector<Index> plan_index;           ///< the inverse [N]
  std::vector<double> relative_mass;       ///< mᵢ/m̄ in the problem's order [N]
  std::vector<double> weight;              ///< mᵢ·g [N]
  std::vector<double> move;                ///< h·q/mᵢ [m/N]
  std::vector<double> speed;               ///< q/(r·mᵢ) [m/(s·N)]
  double keep = 0;                         ///< r of a substep [1]
  double first_keep = 0, first_share = 0;  ///< of the first half substep: r, and q over the full q
  double kick_time = 0;                    ///< q of a substep [s]
  double particle_mass = 0;                ///< m̄ [kg]
  double damping_ratio = 0;                ///< ζ of the control force

  /// A particle's springs to those after it: first_spring[i] … first_spring[i + 1] − 1.
  std::vector<Index> first_spring;   ///< [N + 1]
  std::vector<Index> far_end;        ///< [springs]
  std::vector<double> spring;        ///< k + c/h [N/m]
  std::vector<double> rest_tension;  ///< k·ℓ [N]
  std::vector<double> dashpot;       ///< c/h [N/m]; empty where there is no damping

  /// Particles of each hinge, as in Hinges [4 × hinges].
  std::vector<Index> corners;
  std::vector<double> hinge_spring;            ///< k [N·m]
  std::vector<double> rest_cosine, rest_sine;  ///< of θ₀
  std::vector<double> hinge_dashpot;           ///< c/H [N·m]; empty where there is no damping

  Index hinges() const { return static_cast<Index>(hinge_spring.size()); }
};

/// A sheet in flight, in the plan's order: a copyable value.
struct SheetState {
  bool first = true;               ///< before the first step
  std::vector<double> positions;   ///< [3 × N], m
  std::vector<double> impulse;     ///< u of sheet_step-inl.h [3 × N], N
  std::vector<double> velocities;  ///< see sheet_step-inl.h [3 × N], m/s
  std::vector<double> length;      ///< of the springs a substep ago [springs], m; or empty
  std::vector<double> turn;        ///< θ − θ₀ of the hinges a step ago [hinges]; or empty
};

/// At these positions with these velocities [3 × N], in the problem's order.
SheetState begin(const SheetPlan& plan, const Points& positions, const Points& velocities);

/// Advances by one step under the forces [3 × N], in the problem's order.
void step(const SheetPlan& plan, const Points& forces, SheetState& state);

/// Values of the particles in the plan's order, as Points [3 × N] in the problem's.
void in_user_order(const SheetPlan& plan, const std::vector<double>& values, Points& points);

/// Whole flights of one sheet from `start`, one for each of `gains`: final positions [3N] after
/// another in `finals`, and their derivatives with respect to a gain in `derivatives` unless that
/// is null. Equal, bit for bit, to rollouts of the core by `step`.
void fly(const SheetPlan& plan, const ReferenceMotion& reference, const SheetState& start,
         const RolloutGains& gains, double* finals, double* derivatives);

/// Gains that `fly` takes side by side, one a SIMD lane.
Index sheet_lanes();

}  // namespace nuno::native
