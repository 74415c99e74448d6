#pragma once

#include <nuno/backend.h>

#include <functional>
#include <string>
#include <utility>

#include "bare_problem.h"

namespace nuno {

/// What a scripted cloth knows when it takes a step.
struct Moment {
  Index step = 0;            ///< that it takes: 1 … steps
  const Points& positions;   ///< before it [d × N], m
  const Points& velocities;  ///< over the last step; the launch velocity before the first
  const Points& forces;      ///< during it
};

/// An engine whose motion is a formula, so that what flies, searches and measures can be told
/// exactly what it must find.
class ScriptedBackend final : public Backend {
 public:
  /// Where the particles are after a step [d × N].
  using Motion = std::function<Points(const Moment&)>;
  using Jacobian = std::function<RolloutJacobian(const CorrectionDirections&)>;

  ScriptedBackend(const Problem& problem, Index steps, Motion motion)
      : Backend("scripted", problem, steps), motion_(std::move(motion)) {}

  Jacobian jacobian_of;     ///< what `jacobian` gives
  std::string last_words;   ///< what a simulation of it gives as its failure
  double most_gain = 1e30;  ///< its largest gain

 private:
  class Flight final : public Simulation {
   public:
    Flight(const ScriptedBackend& engine, Points positions, Points velocities)
        : engine_(engine), positions_(std::move(positions)), velocities_(std::move(velocities)) {}

    void step(const Points& forces) override {
      const Points next = engine_.motion_({++step_, positions_, velocities_, forces});
      velocities_ = (next - positions_) / engine_.time_step();
      positions_ = next;
    }
    const Points& positions() const override { return positions_; }
    const Points& velocities() const override { return velocities_; }
    std::string_view failure() const override { return engine_.last_words; }

   private:
    const ScriptedBackend& engine_;
    Index step_ = 0;
    Points positions_, velocities_;
  };

  std::unique_ptr<Simulation> do_start(const Points& positions,
                                       const Points& velocities) const override {
    return std::make_unique<Flight>(*this, positions, velocities);
  }
  DragRecurrence do_drag_recurrence() const override { return {time_step(), 1, 0, 1, 0}; }
  double do_largest_gain() const override { return most_gain; }
  RolloutJacobian do_jacobian(double /*gain*/, const CorrectionDirections& along) const override {
    return jacobian_of(along);
  }

  Motion motion_;
};

/// Four particles a distance of 1 from their centroid, the origin.
inline Points cross() { return Points{{1, 0, -1, 0}, {0, 1, 0, -1}}; }

/// An engine of which error and effort are known at every gain: its cloth stays in the shape
/// `cross` until the last step, and then is `error(α)` off its target, every particle. Its control
/// force is α on every particle throughout, so that the effort is α over effort_unit.
inline ScriptedBackend engine_of_error(std::function<double(double gain)> error) {
  Problem problem = problem_of(cross());
  problem.target = 2 * cross();
  const Index steps = 5;
  return {problem, steps, [=](const Moment& now) -> Points {
            const double gain = now.forces.col(0).norm();
            if (now.step < steps) return cross();
            return problem.target + error(gain) * Points{{1, -1, 1, -1}, {0, 0, 0, 0}};
          }};
}

}  // namespace nuno
