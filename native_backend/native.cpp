#include <nuno/native.h>

#include <nuno/error.h>
#include <nuno/launch.h>
#include <nuno/parallel.h>
#include <nuno/rollout.h>
#include <nuno/shape_control.h>

#include "arrivals.h"
#include "chain_kernel.h"
#include "chain_steps.h"
#include "sheet_backend.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace nuno::native {
namespace {

/// (1 − e^(−κh))/κ: how long a kick of h lasts under drag [s].
double kick_duration(double drag_rate, double h) {
  return drag_rate * h > 0 ? -std::expm1(-drag_rate * h) / drag_rate : h;
}

/// How much of a step's change of length or angle, after and before, a kick adds to its present
/// one.
struct Weights {
  double after, before;
};

ChainPlan::Kick make_kick(const Chain& chain, double h, double duration, Weights length,
                          Weights turn) {
  const double stiffness = chain.material.stretch_stiffness;
  const double damping = chain.material.stretch_damping;
  const double q = kick_duration(chain.drag_rate, duration);
  ChainPlan::Kick kick;
  kick.keep = std::exp(-chain.drag_rate * duration);
  kick.fall = q * chain.gravity;
  kick.force = q / chain.particle_mass;
  const double after = stiffness * h * length.after + damping / 2;
  const double before = stiffness * h * length.before + damping / 2;
  kick.strain = stiffness / after;
  kick.rate = before / after;
  kick.compliance = 1 / (after * kick.force);
  const double hinge = chain.material.hinge_stiffness, dashpot = chain.material.hinge_damping;
  const double hinge_after = hinge * h * turn.after + dashpot / 2;
  kick.hinge_strain = hinge / hinge_after;
  kick.hinge_rate = (hinge * h * turn.before + dashpot / 2) / hinge_after;
  kick.hinge_compliance = 1 / (hinge_after * kick.force);
  return kick;
}

/// Of a problem that outlives it.
ChainPlan make_plan(const Problem& problem, const ChainSteps& chosen) {
  const Chain& chain = problem.chain();
  ChainPlan plan;
  plan.particles = chain.particles();
  plan.steps = chosen.count;
  plan.h = problem.arrival_time / static_cast<double>(chosen.count);
  plan.rest_length = {chain.rest_length.data(), static_cast<std::size_t>(chain.particles() - 1)};
  const auto at_hinges = [&](double value) {
    std::vector<double> result(static_cast<std::size_t>(chain.particles()), 0.0);
    for (Index i = 0; i < chain.hinge_length.size(); ++i) {
      result[static_cast<std::size_t>(i + 1)] = value / chain.hinge_length[i];
    }
    return result;
  };
  plan.hinge_spring = at_hinges(chain.material.hinge_stiffness);
  if (chain.material.hinge_damping > 0)
    plan.hinge_dashpot = at_hinges(chain.material.hinge_damping);
  plan.implicit_hinges = chosen.implicit_hinges;
  plan.hinge_length = {chain.hinge_length.data(), static_cast<std::size_t>(chain.particles() - 2)};
  plan.particle_mass = chain.particle_mass;
  plan.damping_ratio = problem.damping_ratio;
  // At the start, positions before and after are in mirror: s₋ + s₊ = 2s + 2h·(ṡ' − ṡ).
  constexpr double b = 0.3;  // see implicit_hinges-inl.h
  plan.first = make_kick(chain, plan.h, plan.h / 2, {0.5, 0}, {2 * b, -2 * b});
  plan.full = make_kick(chain, plan.h, plan.h, {0.25, -0.25}, {b, -b});
  return plan;
}

class ChainSimulation final : public Simulation {
 public:
  ChainSimulation(const ChainPlan& plan, const Points& positions, const Points& velocities)
      : plan_(plan), positions_(positions), velocities_(velocities), scratch_(plan) {}

  void step(const Points& forces) override {
    native::step(plan_, first_, forces.data(), positions_.data(), velocities_.data(), scratch_);
    first_ = false;
  }
  const Points& positions() const override { return positions_; }
  const Points& velocities() const override { return velocities_; }

 private:
  const ChainPlan& plan_;
  Points positions_;
  Points velocities_;
  ScalarScratch scratch_;
  bool first_ = true;
};

class NativeBackend final : public Backend {
 public:
  NativeBackend(Problem problem, const ChainSteps& chosen)
      : Backend("native", std::move(problem), chosen.count),
        plan_(make_plan(this->problem(), chosen)) {}

 private:
  DragRecurrence do_drag_recurrence() const override {
    const double rate = cloth().drag_rate;
    const double h = time_step();
    return {h, plan_.first.keep, kick_duration(rate, h / 2), plan_.full.keep,
            kick_duration(rate, h)};
  }

  std::unique_ptr<Simulation> do_start(const Points& positions,
                                       const Points& velocities) const override {
    return std::make_unique<ChainSimulation>(plan_, positions, velocities);
  }

  std::vector<double> do_errors(std::span<const Gains> gains,
                                const Points& initial) const override {
    const GroupedRollouts flights(*this, gains, 1);
    std::vector<double> result;
    for (const Arrival& arrival : fly_over(flights.gains(), initial, false)) {
      result.push_back(arrival.error);
    }
    return result;
  }

  bool do_has_derivatives() const override { return true; }

  std::vector<ErrorSample> do_error_samples(std::span<const Gains> gains) const override {
    if (gains.empty()) return {};
    const Index groups = gains.front().count();
    const GroupedRollouts flights(*this, gains, groups);
    return samples_of(fly_over(flights.gains(), cloth().initial, true), groups);
  }

  RolloutJacobian do_jacobian(double gain, const CorrectionDirections& directions) const override {
    const ReferenceMotion reference(problem(), time_step());
    const Points& initial = cloth().initial;
    const Index size = initial.size();
    const Index count = directions.shapes.cols();
    Eigen::MatrixXd shapes(size, count), launches(size, count);
    for (Index d = 0; d < count; ++d) {
      const auto power = static_cast<std::size_t>(directions.powers[static_cast<std::size_t>(d)]);
      const Points shape = shape_of(directions.shapes.col(d).reshaped(2, size / 2));
      const Points turned = reference.correction_rates()[power] * shape;
      shapes.col(d) = shape.reshaped();
      launches.col(d) =
          (problem().launch == Launch::inextensible ? without_stretching(initial, turned) : turned)
              .reshaped();
    }

    // The nearer to arrival, where the forces are strong and short, the closer.
    constexpr Index most_samples = 24;
    std::vector<Index> samples;
    std::vector<double> weights;
    Index sampled = 0;
    for (Index k = 0; k < most_samples; ++k) {
      const double left = 1 - static_cast<double>(k + 1) / most_samples;
      const Index end =
          static_cast<Index>(std::llround((1 - left * left) * static_cast<double>(steps())));
      if (end == sampled) continue;
      samples.push_back((sampled + end) / 2);
      weights.push_back(
          std::sqrt(static_cast<double>(end - sampled) /
                    (static_cast<double>(steps()) * static_cast<double>(initial.cols()))) /
          effort_unit(problem()));
      sampled = end;
    }

    RolloutJacobian jacobian;
    const Index forces = size * static_cast<Index>(samples.size());
    jacobian.arrival.resize(size, count);
    jacobian.forces.resize(forces);
    jacobian.forces_jacobian.setZero(forces, count);
    const std::vector<RolloutState> starts = fly_once(gain, samples, jacobian.forces);
    const Index batch = derivative_lanes();
    parallel_for((count + batch - 1) / batch, [&](Index b) {
      const Index first = b * batch;
      const Index here = std::min(batch, count - first);
      const Index* powers = directions.powers.data() + first;
      fly_along(plan_, starts[static_cast<std::size_t>(*std::min_element(powers, powers + here))],
                gain, {here, shapes.col(first).data(), powers, launches.col(first).data()}, samples,
                {jacobian.arrival.col(first).data(), jacobian.forces_jacobian.col(first).data()});
    });
    const Eigen::Map<const Vector> weight(weights.data(), static_cast<Index>(weights.size()));
    const Vector each = weight.transpose().replicate(size, 1).reshaped();
    jacobian.forces.array() *= each.array();
    jacobian.forces_jacobian.array().colwise() *= each.array();
    return jacobian;
  }

  /// The control forces at the samples, and the flight where each of correction_powers begins to be
  /// felt.
  std::vector<RolloutState> fly_once(double gain, std::span<const Index> samples,
                                     Vector& forces) const {
    constexpr double felt = 1e-12;  // of the rate at which an offset comes in, times t₀
    const ShapeControl control(problem(), gain);
    ReferenceMotion reference(problem(), time_step());
    ChainSimulation cloth(plan_, problem().cloth().initial, launch(*this));
    Points force = Points::Zero(2, plan_.particles);
    std::vector<RolloutState> starts;
    std::size_t sample = 0;
    for (Index step = 0; starts.size() < correction_powers.size() || sample < samples.size();
         ++step) {
      while (starts.size() < correction_powers.size() &&
             (reference.correction_rates()[starts.size()] * problem().arrival_time > felt ||
              step + 1 == steps())) {
        starts.push_back({step, reference, cloth.positions(), cloth.velocities()});
      }
      if (control.pulls()) control.pull(reference, cloth.positions(), cloth.velocities(), force);
      if (sample < samples.size() && samples[sample] == step) {
        forces.segment(static_cast<Index>(sample++) * force.size(), force.size()) =
            force.reshaped();
      }
      cloth.step(force);
      reference.advance();
    }
    return starts;
  }

  std::vector<Arrival> fly_over(const RolloutGains& gains, const Points& initial,
                                bool with_derivatives) const {
    const Points velocities = launch(*this);
    const Index count = gains.flights();
    std::vector<Arrival> arrivals(static_cast<std::size_t>(count));
    const Index batch = lanes();
    parallel_for((count + batch - 1) / batch, [&](Index b) {
      const Index first = b * batch;
      const RolloutGains here = gains.part(first, std::min(batch, count - first));
      fly_batch(here, initial, velocities, with_derivatives,
                std::span(arrivals).subspan(static_cast<std::size_t>(first)));
    });
    return arrivals;
  }

  void fly_batch(const RolloutGains& gains, const Points& initial, const Points& velocities,
                 bool with_derivatives, std::span<Arrival> arrivals) const {
    const Index size = problem().target.size();
    const Index count = gains.flights();
    std::vector<double> finals(static_cast<std::size_t>(size * count));
    std::vector<double> derivatives(with_derivatives ? finals.size() : 0);
    fly(plan_, ReferenceMotion(problem(), time_step()), initial.data(), velocities.data(), gains,
        finals.data(), with_derivatives ? derivatives.data() : nullptr);
    for (Index lane = 0; lane < count; ++lane) {
      arrivals[static_cast<std::size_t>(lane)] =
          arrival_of(problem(), finals.data() + lane * size,
                     with_derivatives ? derivatives.data() + lane * size : nullptr);
    }
  }

  ChainPlan plan_;
};

}  // namespace

std::unique_ptr<Backend> make_backend(const Problem& problem) {
  if (problem.is_sheet()) return make_sheet_backend(problem);
  return std::make_unique<NativeBackend>(problem, choose_chain_steps(problem));
}

}  // namespace nuno::native
