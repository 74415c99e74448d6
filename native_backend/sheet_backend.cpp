#include "sheet_backend.h"

#include <nuno/error.h>
#include <nuno/launch.h>
#include <nuno/parallel.h>
#include <nuno/rollout.h>

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
    if (has_groups(gains)) {
      std::vector<double> errors(gains.size());
      parallel_for(static_cast<Index>(gains.size()), [&](Index i) {
        const auto at = static_cast<std::size_t>(i);
        errors[at] = rollout(*this, gains[at], {}, initial).error.mean;
      });
      return errors;
    }
    std::vector<double> result;
    for (const ErrorSample& sample : fly_all(gains, initial, false)) {
      result.push_back(sample.error);
    }
    return result;
  }

  static bool has_groups(std::span<const Gains> gains) {
    return std::ranges::any_of(gains, [](const Gains& each) { return each.count() > 1; });
  }

  bool do_has_derivatives() const override { return true; }

  std::vector<ErrorSample> do_error_samples(std::span<const Gains> gains) const override {
    return fly_all(gains, cloth().initial, true);
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

  std::vector<ErrorSample> fly_all(std::span<const Gains> gains, const Points& initial,
                                   bool with_derivatives) const {
    std::vector<double> values;
    for (const Gains& each : gains) values.push_back(each.rest);
    std::vector<ErrorSample> samples(gains.size());
    const SheetState start = begin(plan_, initial, launch(*this));
    const ReferenceMotion reference(problem(), time_step());
    const auto batch = static_cast<std::size_t>(sheet_lanes());
    parallel_for(static_cast<Index>((values.size() + batch - 1) / batch), [&](Index b) {
      const std::size_t first = static_cast<std::size_t>(b) * batch;
      const std::size_t count = std::min(batch, values.size() - first);
      const Points& target = problem().target;
      std::vector<double> finals(static_cast<std::size_t>(target.size()) * count);
      std::vector<double> derivatives(with_derivatives ? finals.size() : 0);
      fly(plan_, reference, start, std::span(values).subspan(first, count), finals.data(),
          with_derivatives ? derivatives.data() : nullptr);
      for (std::size_t lane = 0; lane < count; ++lane) {
        const std::size_t at = lane * static_cast<std::size_t>(target.size());
        samples[first + lane] =
            sample_of(finals.data() + at, with_derivatives ? derivatives.data() + at : nullptr);
      }
    });
    return samples;
  }

  ErrorSample sample_of(const double* finals, const double* derivatives) const {
    const Points& target = problem().target;
    const Eigen::Map<const Points> final(finals, 3, target.cols());
    ErrorSample sample;
    if (derivatives != nullptr) sample.derivatives.emplace_back();
    if (is_torn(cloth(), final)) {
      sample.error = std::numeric_limits<double>::infinity();
      return sample;
    }
    sample.error = arrival_error(final, target).mean;
    if (derivatives == nullptr) return sample;
    sample.residual = final - target;
    ErrorSample::Derivative& derivative = sample.derivatives.front();
    derivative.residual = Eigen::Map<const Points>(derivatives, 3, target.cols());
    double sum = 0;
    for (Index i = 0; i < target.cols(); ++i) {
      const double distance = sample.residual.col(i).norm();
      if (distance > 0) {
        sum += sample.residual.col(i).dot(derivative.residual.col(i)) / distance;
      }
    }
    derivative.error = sum / static_cast<double>(target.cols());
    return sample;
  }

  SheetPlan plan_;
};

}  // namespace

std::unique_ptr<Backend> make_sheet_backend(const Problem& problem) {
  return std::make_unique<SheetBackend>(problem, choose_steps(problem));
}

}  // namespace nuno::native
