#include <nuno/shape_control.h>
#include <nuno/sheet_stiffness.h>

#include <Eigen/QR>
#include <Eigen/SparseCholesky>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "refinement.h"

namespace nuno {
namespace {

using SparseMatrix = Eigen::SparseMatrix<double>;

/// Which of correction_powers a sheet is corrected by: early, so that launch and flight turn, where
/// it is soft; late, in the last thirtieth of the way, where it is stiff, so that what holds it
/// there is a short push.
constexpr std::size_t early_power = 0, late_power = 2;

/// A change of the reference correction [3N each, a particle after another], m.
struct Step {
  Vector early, late;
};

Step operator*(double factor, const Step& step) {
  return {factor * step.early, factor * step.late};
}
Step& operator+=(Step& to, const Step& step) {
  to.early += step.early;
  to.late += step.late;
  return to;
}

/// Lets displacements of a sheet through that its stiffness K does not oppose more than masses m do
/// at a frequency ω: (m + K/ω²)⁻¹·m.
class LowPass {
 public:
  LowPass(const SparseMatrix& stiffness, const Vector& masses, double squared_frequency)
      : masses_(masses) {
    SparseMatrix system = stiffness / squared_frequency;
    for (Index i = 0; i < masses.size(); ++i) system.coeffRef(i, i) += masses[i];
    factor_.compute(system);
  }

  Vector operator()(const Vector& displacement) const {
    return factor_.solve(masses_.cwiseProduct(displacement));
  }

 private:
  const Vector& masses_;
  Eigen::SimplicialLDLT<SparseMatrix> factor_;
};

/// An estimate of the inverse Jacobian of arrivals by the reference correction, without a flight.
/// About the target a sheet under control is nearly a linear oscillator,
///     ẍ + b·ẋ + (M⁻¹K + a)·x = a·w·δ + b·ẇ·δ,   a = α/m̄, b = β/m̄,
/// which follows a late correction δ, w ≈ exp((t − t₀)/τ), by x = (a + b/τ)/(λ + a + b/τ + 1/τ²)·δ
/// for each eigenvalue λ of M⁻¹K: a product with the stiffness matrix K undoes it. An early one,
/// that its launch goes along with, is followed by a/(λ + a): as it is where the sheet is soft.
class QuasiStaticModel {
 public:
  QuasiStaticModel(const Problem& problem, double gain)
      : stiffness_(stiffness_matrix(problem.sheet(), problem.target)),
        masses_((problem.cloth().particle_mass * problem.cloth().relative_mass)
                    .transpose()
                    .replicate(3, 1)
                    .reshaped()) {
    const double mass = problem.cloth().particle_mass;
    pull_ = gain / mass;
    const double brake = shape_damping(problem.damping_ratio, gain, mass) / mass;
    const double rate = correction_powers[late_power] / problem.arrival_time;  // 1/τ
    late_pull_ = pull_ + brake * rate;
    late_inertia_ = late_pull_ + rate * rate;
  }

  /// Squared frequency of the control [1/s²]: what is softer is corrected early.
  double soft() const { return pull_; }

  std::unique_ptr<const LowPass> low_pass(double squared_frequency) const {
    return std::make_unique<const LowPass>(stiffness_, masses_, squared_frequency);
  }

  Vector late(const Vector& displacement) const {
    return (accelerations(displacement) + late_inertia_ * displacement) / late_pull_;
  }

 private:
  Vector accelerations(const Vector& displacement) const {
    return (stiffness_ * displacement).cwiseQuotient(masses_);
  }

  SparseMatrix stiffness_;
  Vector masses_;  // of the coordinates [3N], kg
  double pull_ = 0, late_pull_ = 0, late_inertia_ = 0;
};

/// The last steps, and the changes of the residual that they made.
class Secants {
 public:
  void learn(const Step& step, const Vector& change) {
    constexpr std::size_t most = 10;
    if (pairs_.size() == most) pairs_.erase(pairs_.begin());
    pairs_.push_back({step, change});
  }

  /// The combination of known steps that leaves the least of the residual behind `filter`; takes
  /// from the residual what it foretells.
  Step fit(const LowPass& filter, Vector& residual) const {
    Step step{Vector::Zero(residual.size()), Vector::Zero(residual.size())};
    if (pairs_.empty()) return step;
    Eigen::MatrixXd changes(residual.size(), static_cast<Index>(pairs_.size()));
    for (std::size_t k = 0; k < pairs_.size(); ++k) {
      changes.col(static_cast<Index>(k)) = filter(pairs_[k].change);
    }
    const Vector shares = changes.colPivHouseholderQr().solve(-filter(residual));
    for (std::size_t k = 0; k < pairs_.size(); ++k) {
      step += shares[static_cast<Index>(k)] * pairs_[k].step;
      residual += shares[static_cast<Index>(k)] * pairs_[k].change;
    }
    return step;
  }

 private:
  struct Pair {
    Step step;
    Vector change;
  };
  std::vector<Pair> pairs_;
};

/// A multisecant quasi-Newton method (Anderson 1965; Fang and Saad 2009) on the residual at
/// arrival: what known steps explain of it is taken from them, the rest from the model, and every
/// flight, a rejected one too, teaches a step. Soft shapes come first: the steps see the residual
/// through a low-pass filter whose bandwidth grows as they succeed, since what is stiff is hidden
/// by what is soft and large, and pushing for it then would buckle the cloth.
class SheetRefinement {
 public:
  SheetRefinement(const Problem& problem, double gain, const MakeBackend& make,
                  const RefineOptions& options)
      : problem_(problem),
        gain_(gain),
        make_(make),
        options_(options),
        size_(problem.cloth().size),
        tolerance_(std::max(options.tolerance, least_tolerance)),
        within_reach_(is_within_reach(problem, make)),
        model_(problem, gain),
        summary_(first_flight(problem, gain, make, options)) {
    const double step = make(problem)->time_step();
    widest_ = std::max(model_.soft(), 1 / (3 * step * step));
    set_bandwidth(model_.soft());
  }

  RefineSummary run() {
    for (Index round = 0; round < options_.rounds && !is_over(); ++round) try_step();
    if (summary_.flight.status == RolloutStatus::diverged) summary_.reason = "the flight diverged";
    conclude(summary_, tolerance_ * size_, options_.effort_limit);
    return std::move(summary_);
  }

 private:
  /// Of an arrival, over L: what is nearer is the work of the rounding of many flights.
  static constexpr double least_tolerance = 1e-6;
  static constexpr double growth = 4;  // of the squared bandwidth
  static constexpr int most_failures = 6;

  Vector residual(const Rollout& flight) const {
    return (problem_.target - flight.final).reshaped();
  }

  void set_bandwidth(double squared_frequency) {
    bandwidth_ = std::clamp(squared_frequency, model_.soft(), widest_);
    visible_ = model_.low_pass(bandwidth_);
  }

  bool is_over() const {
    return summary_.flight.error.mean <= tolerance_ * size_ ||
           summary_.flight.status == RolloutStatus::diverged || failures_ == most_failures;
  }

  Step proposed() const {
    Vector left = residual(summary_.flight);
    Step step = secants_.fit(*visible_, left);
    const Vector seen = (*visible_)(left);
    const Vector soft = bandwidth_ > model_.soft() ? (*soft_)(left) : seen;
    step.early += soft;
    step.late += model_.late(seen - soft);
    return step;
  }

  void try_step() {
    const Step step = stride_ * proposed();
    std::vector<Points> correction = summary_.reference_correction;
    correction[early_power] += step.early.reshaped(3, problem_.cloth().particles());
    correction[late_power] += step.late.reshaped(3, problem_.cloth().particles());
    Problem corrected = problem_;
    corrected.reference_correction = correction;
    Rollout flight = rollout(*make_(corrected), gain_);
    ++summary_.rollouts;
    if (flight.status == RolloutStatus::diverged) return fail();

    const Vector before = residual(summary_.flight), after = residual(flight);
    secants_.learn(step, after - before);
    if (takes_too_much(flight)) return shorten();
    if (!is_better(flight)) return fail();
    const bool widens = (*visible_)(after).norm() < 0.5 * (*visible_)(before).norm();
    summary_.flight = std::move(flight);
    summary_.reference_correction = std::move(correction);
    failures_ = 0;
    stride_ = std::min(1.0, 2 * stride_);
    if (widens && bandwidth_ < widest_) set_bandwidth(growth * bandwidth_);
  }

  bool takes_too_much(const Rollout& flight) const {
    return flight.control_effort > std::max(options_.effort_limit, summary_.flight.control_effort);
  }

  /// Nearer and, out of reach, worth its effort.
  bool is_better(const Rollout& flight) const {
    const auto cost = [&](const Rollout& of) {
      return std::hypot(of.control_effort, worth_of_error * of.error.mean / size_);
    };
    return flight.error.mean < summary_.flight.error.mean &&
           (within_reach_ || std::isfinite(options_.effort_limit) ||
            cost(flight) < cost(summary_.flight));
  }

  /// The next step has learnt from this one; after two in a row, it sees less.
  void fail() {
    if (++failures_ % 2 == 0) set_bandwidth(bandwidth_ / growth);
    summary_.reason = within_reach_ ? "no correction brings it nearer"
                                    : "the cloth's edges do not fit the target's; this is as near "
                                      "as is worth it";
  }

  /// The next step goes a smaller part of its way.
  void shorten() {
    ++failures_;
    stride_ /= 3;
    summary_.reason = no_more_effort;
  }

  const Problem& problem_;
  const double gain_;
  const MakeBackend& make_;
  const RefineOptions& options_;
  const double size_;       // L
  const double tolerance_;  // over L
  const bool within_reach_;
  const QuasiStaticModel model_;
  const std::unique_ptr<const LowPass> soft_ = model_.low_pass(model_.soft());

  RefineSummary summary_;
  Secants secants_;
  double bandwidth_ = 0, widest_ = 0;  // squared frequencies [1/s²]
  std::unique_ptr<const LowPass> visible_;
  int failures_ = 0;   // in a row
  double stride_ = 1;  // part of a proposed step that is gone
};

}  // namespace

RefineSummary refine_sheet(const Problem& problem, double gain, const MakeBackend& make,
                           const RefineOptions& options) {
  return SheetRefinement(problem, gain, make, options).run();
}

}  // namespace nuno
