#pragma once

#include <nuno/gains.h>
#include <nuno/problem.h>
#include <nuno/rollout_gradient.h>

#include <array>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

namespace nuno {

/// How an engine integrates the flight of a lone particle, in n steps of h:
///     v₁ = r₁·v₀ − q₁·g,   vₙ₊₁ = r·vₙ − q·g,   xₙ₊₁ = xₙ + h·vₙ₊₁.
/// A launch that is solved for an engine's own recurrence arrives to rounding.
struct DragRecurrence {
  double h = 0;           ///< time step [s]
  double r1 = 0, q1 = 0;  ///< the first step: [1], [s]
  double r = 0, q = 0;    ///< every other step: [1], [s]
};

/// One cloth in flight: the state that steps change.
class Simulation {
 public:
  virtual ~Simulation() = default;

  /// Advances by one time step under an external force on every particle [d × N], N.
  virtual void step(const Points& forces) = 0;

  virtual const Points& positions() const = 0;  ///< [d × N], m

  /// Mean velocity over the last step (the launch velocity before the first) [d × N], m/s.
  virtual const Points& velocities() const = 0;

  /// Why the engine gave this flight up, in its own words; empty while it flies, and for an engine
  /// that lets bad numbers run.
  virtual std::string_view failure() const { return {}; }
};

/// How a flight arrives under some gains, and the derivatives with respect to each of them.
struct ErrorSample {
  struct Derivative {
    /// dE/dα [m²/N]; damped and at α = 0, where it is infinite, of the springs; 0 where the rollout
    /// diverged.
    double error = 0;
    Points residual;  ///< [d × N], m²/N; empty where it diverged
  };

  double error = 0;  ///< E [m]; +∞ where the rollout diverged
  Points residual;   ///< final positions less the target [d × N], m; empty where it diverged
  std::vector<Derivative> derivatives;  ///< by the gain of every group
};

/// Ways to change a problem's reference correction: each adds a shape to that of one of
/// correction_powers.
struct CorrectionDirections {
  std::vector<Index> powers;  ///< which of correction_powers, for each direction
  Eigen::MatrixXd shapes;     ///< [d·N × directions], a particle after another, m
};

/// A flight, and its derivatives along some directions.
struct RolloutJacobian {
  Eigen::MatrixXd arrival;  ///< of the particles' positions at arrival [d·N × directions]
  /// Control forces at some times on the way, weighted so that their squares sum to the square of
  /// the control effort (see Rollout) as nearly as the times tell.
  Vector forces;
  Eigen::MatrixXd forces_jacobian;  ///< of these [size of forces × directions]
};

/// Steps of a flight that an engine takes at most.
inline constexpr double most_steps = 50e6;

/// An engine, made ready for one problem: const, and shared by any number of threads.
///
/// Who writes one says how it begins and what its drag recurrence is; all else has a default.
class Backend {
 public:
  virtual ~Backend() = default;

  std::string_view name() const { return name_; }
  const Problem& problem() const { return problem_; }
  const Cloth& cloth() const { return problem_.cloth(); }
  double time_step() const { return problem_.arrival_time / static_cast<double>(steps_); }
  Index steps() const { return steps_; }  ///< a whole number of them ends at t₀

  /// The largest gain that the time step resolves [N/m].
  double largest_gain() const { return do_largest_gain(); }
  DragRecurrence drag_recurrence() const { return do_drag_recurrence(); }

  /// The problem's low modes where there are `groups` groups, found when they are first asked for.
  const LowModes& low_modes(Index groups) const;

  /// A cloth at these positions (the initial ones, if they are left out) with these velocities
  /// [d × N], m and m/s. Its edges are at rest at the lengths of the problem's cloth.
  std::unique_ptr<Simulation> start(const Points& positions, const Points& velocities) const {
    return do_start(positions, velocities);
  }
  std::unique_ptr<Simulation> start(const Points& velocities) const {
    return do_start(cloth().initial, velocities);
  }

  /// The smallest perturbation of the initial positions, over L, whose growth the engine's
  /// arithmetic lets one measure.
  double smallest_perturbation() const { return do_smallest_perturbation(); }

  /// E under many gains, as many groups in each, as `rollout` gives it, from these positions
  /// [d × N]; the initial ones, if they are left out.
  std::vector<double> errors(std::span<const Gains> gains, const Points& initial) const {
    return do_errors(gains, initial);
  }
  std::vector<double> errors(std::span<const Gains> gains) const {
    return do_errors(gains, cloth().initial);
  }

  /// Whether the two below are there: an engine that knows its derivatives.
  bool has_derivatives() const { return do_has_derivatives(); }

  /// E and its derivatives under many gains, as many groups in each, from the initial positions.
  std::vector<ErrorSample> error_samples(std::span<const Gains> gains) const {
    return do_error_samples(gains);
  }

  /// The flight at one gain, and its derivatives along these directions.
  RolloutJacobian jacobian(double gain, const CorrectionDirections& directions) const {
    return do_jacobian(gain, directions);
  }

  /// Whether `gradient` is there: an engine that knows the adjoint of its steps.
  bool has_gradient() const { return do_has_gradient(); }

  /// The flight at one gain from the initial positions, and the gradient of a quantity J of it, of
  /// which `cotangent_at` is asked once, after the flight. Costs a few flights however many
  /// directions there are, and memory as the root of the number of steps.
  RolloutGradient gradient(double gain, const CotangentAt& cotangent_at) const {
    return do_gradient(gain, cotangent_at);
  }
  /// Of J = Σ ⟨arrival_cotangent, final positions⟩, both [d × N]: a product with the transposed
  /// Jacobian.
  RolloutGradient gradient(double gain, const Points& arrival_cotangent) const;
  /// Of E [m].
  RolloutGradient error_gradient(double gain) const;

  /// `errors` and `error_samples` at many values of one gain for all modes.
  std::vector<double> errors(std::span<const double> gains) const;
  std::vector<ErrorSample> error_samples(std::span<const double> gains) const;

 protected:
  /// `name` must live as long as the program: a literal.
  Backend(std::string_view name, Problem problem, Index steps)
      : name_(name), problem_(std::move(problem)), steps_(steps) {}

 private:
  virtual std::unique_ptr<Simulation> do_start(const Points& positions,
                                               const Points& velocities) const = 0;
  virtual DragRecurrence do_drag_recurrence() const = 0;

  /// By default of √(α/m)·h = 0.2 rad, where the control's own oscillation takes 30 steps.
  virtual double do_largest_gain() const;
  /// By default for double precision: a millionth of it is the rounding of a flight (1e-14).
  virtual double do_smallest_perturbation() const { return 1e-8; }
  /// By default a rollout each, over all cores.
  virtual std::vector<double> do_errors(std::span<const Gains> gains, const Points& initial) const;
  virtual bool do_has_derivatives() const { return false; }
  virtual std::vector<ErrorSample> do_error_samples(std::span<const Gains> gains) const;
  virtual RolloutJacobian do_jacobian(double gain, const CorrectionDirections& directions) const;
  virtual bool do_has_gradient() const { return false; }
  virtual RolloutGradient do_gradient(double gain, const CotangentAt& cotangent_at) const;

  std::string_view name_;
  Problem problem_;
  Index steps_;
  struct Found {
    std::once_flag once;
    std::optional<LowModes> modes;
  };
  mutable std::array<Found, most_groups> low_modes_;
};

}  // namespace nuno
