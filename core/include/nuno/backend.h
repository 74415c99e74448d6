#pragma once

#include <nuno/gains.h>
#include <nuno/problem.h>

#include <memory>
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

  /// Advances by one time step under an external force on every particle [2 × N], N.
  virtual void step(const Points& forces) = 0;

  virtual const Points& positions() const = 0;  ///< [2 × N], m

  /// Mean velocity over the last step (the launch velocity before the first) [2 × N], m/s.
  virtual const Points& velocities() const = 0;

  /// Why the engine gave this flight up, in its own words; empty while it flies, and for an engine
  /// that lets bad numbers run.
  virtual std::string_view failure() const { return {}; }
};

/// How a flight arrives under some gains, and the derivatives with respect to each of them.
struct ErrorSample {
  struct Slope {
    /// dE/dα [m²/N]; damped and at α = 0, where it is infinite, of the springs; 0 where the rollout
    /// diverged.
    double error = 0;
    Points miss;  ///< [2 × N], m²/N; empty where it diverged
  };

  double error = 0;  ///< E [m]; +∞ where the rollout diverged
  Points miss;       ///< final positions less the target [2 × N], m; empty where it diverged
  std::vector<Slope> slopes;  ///< by the gain of every group
};

/// Ways to change a problem's aim offset: each adds a shape to the offset of one of aim_powers.
struct AimDirections {
  std::vector<Index> powers;  ///< which of aim_powers, for each direction
  Eigen::MatrixXd shapes;     ///< [2N × directions], x₀ y₀ x₁ y₁ …, m
};

/// A flight, and its derivatives along some directions.
struct FlightTangent {
  Eigen::MatrixXd arrival;  ///< of the particles' positions at arrival [2N × directions]
  /// Control forces at some times on the way, weighted so that their squares sum to the square of
  /// the control effort (see Rollout) as nearly as the times tell.
  Vector forces;
  Eigen::MatrixXd forces_tangent;  ///< of these [size of forces × directions]
};

/// Steps of a flight that an engine takes at most.
inline constexpr double most_steps = 50e6;

/// An engine, made ready for one problem: const, and shared by any number of threads.
class Backend {
 public:
  virtual ~Backend() = default;

  virtual std::string_view name() const = 0;
  const Problem& problem() const { return problem_; }
  double time_step() const { return problem_.arrival_time / static_cast<double>(steps_); }
  Index steps() const { return steps_; }  ///< a whole number of them ends at t₀

  /// The largest gain that the time step resolves [N/m]: by default of √(α/m)·h = 0.2 rad, where
  /// the control's own oscillation takes 30 steps.
  virtual double largest_gain() const;
  virtual DragRecurrence drag_recurrence() const = 0;

  /// A cloth at these positions with these velocities [2 × N], m and m/s. Its segments are at rest
  /// at the lengths of the problem's chain.
  virtual std::unique_ptr<Simulation> start(const Points& positions,
                                            const Points& velocities) const = 0;

  std::unique_ptr<Simulation> start(const Points& velocities) const {
    return start(problem_.chain.initial, velocities);
  }

  /// The smallest disturbance of the initial positions, over L, whose growth the engine's
  /// arithmetic lets one measure.
  virtual double smallest_disturbance() const = 0;

  /// E under many gains, as many groups in each, as `rollout` gives it, from these positions
  /// [2 × N]; by default a rollout each, over all cores.
  virtual std::vector<double> errors(std::span<const Gains> gains, const Points& initial) const;
  std::vector<double> errors(std::span<const Gains> gains) const {
    return errors(gains, problem_.chain.initial);
  }

  /// Whether the two below are there: an engine that knows its derivatives.
  virtual bool has_slopes() const { return false; }

  /// E and its derivatives under many gains, as many groups in each, from the initial positions.
  virtual std::vector<ErrorSample> error_samples(std::span<const Gains> gains) const;

  /// The flight at one gain, and its derivatives along these directions.
  virtual FlightTangent flight_tangent(double gain, const AimDirections& directions) const;

  /// `errors` and `error_samples` at many values of one gain for all modes.
  std::vector<double> errors(std::span<const double> gains) const;
  std::vector<ErrorSample> error_samples(std::span<const double> gains) const;

 protected:
  Backend(Problem problem, Index steps) : problem_(std::move(problem)), steps_(steps) {}

 private:
  Problem problem_;
  Index steps_;
};

}  // namespace nuno
