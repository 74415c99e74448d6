#include "sheet_backend.h"

#include <nuno/error.h>
#include <nuno/launch.h>
#include <nuno/parallel.h>
#include <nuno/rollout.h>

#include "arrivals.h"
#include "sheet_adjoint.h"
#include "sheet_kernel.h"
#include "sheet_plan.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace nuno::native {
namespace {

class SheetSimulation final : public Simulation {
 public:
  SheetSimulation(const SheetPlan& plan, const Points& positions, const Points& velocities)
      : plan_(plan),
        state_(begin(plan, positions, velocities)),
        positions_(positions),
        velocities_(velocities) {}

  void step(const Points& forces) override {
    native::step(plan_, forces, state_);
    in_user_order(plan_, state_.positions, positions_);
    in_user_order(plan_, state_.velocities, velocities_);
  }
  const Points& positions() const override { return positions_; }
  const Points& velocities() const override { return velocities_; }

 private:
  const SheetPlan& plan_;
  SheetState state_;
  Points positions_;
  Points velocities_;
};

class SheetBackend final : public Backend {
 public:
  SheetBackend(const Problem& problem, const SheetSteps& steps)
      : Backend("native", problem, steps.steps), plan_(make_sheet_plan(problem, steps)) {}

 private:
  /// A step's velocity is the mean over its substeps: substep j has gone half of one and j − 1
  /// whole ones since the launch.
  DragRecurrence do_drag_recurrence() const override {
    const double rate = cloth().drag_rate;
    const double n = static_cast<double>(plan_.substeps);
    const auto kick_time = [rate](double t) {
      return rate * t > 0 ? -std::expm1(-rate * t) / rate : t;
    };
    DragRecurrence recurrence;
    recurrence.h = time_step();
    for (Index j = 0; j < plan_.substeps; ++j) {
      const double since = (static_cast<double>(j) + 0.5) * plan_.substep;
      recurrence.r1 += std::exp(-rate * since) / n;
      recurrence.q1 += kick_time(since) / n;
    }
    recurrence.r = std::exp(-rate * recurrence.h);
    recurrence.q = kick_time(recurrence.h);
    return recurrence;
  }

  std::unique_ptr<Simulation> do_start(const Points& positions,
                                       const Points& velocities) const override {
    return std::make_unique<SheetSimulation>(plan_, positions, velocities);
  }

  std::vector<double> do_errors(std::span<const Gains> gains,
                                const Points& initial) const override {
    std::vector<double> result;
    for (const Arrival& arrival : fly_over(gains, initial, false)) result.push_back(arrival.error);
    return result;
  }

  bool do_has_derivatives() const override { return true; }

  std::vector<ErrorSample> do_error_samples(std::span<const Gains> gains) const override {
    if (gains.empty()) return {};
    return samples_of(fly_over(gains, cloth().initial, true), gains.front().count());
  }

  bool do_has_gradient() const override { return true; }

  RolloutGradient do_gradient(double gain, const CotangentAt& cotangent_at) const override {
    const SheetState start = begin(plan_, cloth().initial, launch(*this));
    RolloutGradient gradient = fly_back(plan_, problem(), start, gain, cotangent_at);
    if (gradient.launch.size() > 0) {
      gradient.reference_correction = correction_cotangents(
          problem(), std::move(gradient.reference_correction), gradient.launch);
    }
    return gradient;
  }

  /// A flight for each of the gains; with derivatives, one for each of their groups.
  std::vector<Arrival> fly_over(std::span<const Gains> gains, const Points& initial,
                                bool with_derivatives) const {
    if (gains.empty()) return {};
    const GroupedRollouts flights(*this, gains, with_derivatives ? gains.front().count() : 1);
    const RolloutGains all = flights.gains();
    std::vector<Arrival> arrivals(static_cast<std::size_t>(all.flights()));
    const SheetState start = begin(plan_, initial, launch(*this));
    const ReferenceMotion reference(problem(), time_step());
    const Index batch = sheet_lanes();
    parallel_for((all.flights() + batch - 1) / batch, [&](Index b) {
      const Index first = b * batch;
      const RolloutGains here = all.part(first, std::min(batch, all.flights() - first));
      const Index size = problem().target.size();
      std::vector<double> finals(static_cast<std::size_t>(size * here.flights()));
      std::vector<double> derivatives(with_derivatives ? finals.size() : 0);
      fly(plan_, reference, start, here, finals.data(),
          with_derivatives ? derivatives.data() : nullptr);
      for (Index lane = 0; lane < here.flights(); ++lane) {
        arrivals[static_cast<std::size_t>(first + lane)] =
            arrival_of(problem(), finals.data() + lane * size,
                       with_derivatives ? derivatives.data() + lane * size : nullptr);
      }
    });
    return arrivals;
  }

  SheetPlan plan_;
};

}  // namespace

std::unique_ptr<Backend> make_sheet_backend(const Problem& problem) {
  return std::make_unique<SheetBackend>(problem, choose_steps(problem));
}

}  // namespace nuno::native
