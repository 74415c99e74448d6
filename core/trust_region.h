#pragma once

#include <nuno/backend.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <optional>
#include <utility>

namespace nuno {

/// The flight in a local model: forces F + F'Δ, positions at arrival by X'. Every step minimises
///     |F + F'(Δ + δ)|² + w²·|residual − X'δ|² + μ²·|δ|²,
/// so, with H = F'ᵀF' + μ²I and g = F'ᵀ(F + F'Δ),
///     δ = H⁻¹(X'ᵀλ − g),   (X'H⁻¹X'ᵀ + w⁻²)·λ = residual + X'H⁻¹g,
/// which stays well-conditioned as w grows and arrival becomes a condition. A landing lets the
/// forces be, g = 0, and takes away the residual with the least change to them and to the
/// correction. Δ is the way gone since the Jacobian was taken.
class LocalModel {
 public:
  explicit LocalModel(RolloutJacobian jacobian);

  bool is_finite() const { return hessian_.allFinite() && jacobian_.arrival.allFinite(); }
  bool is_fresh() const { return path_.isZero(0); }

  /// `damping` is μ over the size of F'. To be called before the steps below.
  void set_damping(double damping);

  Vector step(const Vector& residual, double weight) const;
  Vector landing(const Vector& residual) const;

  /// By how much a step lets the objective fall.
  double predicted_reduction(const Vector& residual, double weight, const Vector& step) const;

  void go(const Vector& step) { path_ += step; }

 private:
  Vector forces(const Vector& path) const {
    return jacobian_.forces + jacobian_.forces_jacobian * path;
  }

  RolloutJacobian jacobian_;
  Eigen::MatrixXd hessian_;             // F'ᵀF', lower half
  Vector path_;                         // Δ
  Eigen::LLT<Eigen::MatrixXd> factor_;  // of H
  Eigen::MatrixXd across_;              // H⁻¹X'ᵀ
  Eigen::MatrixXd reach_;               // X'H⁻¹X'ᵀ
};

/// The local model and how far it is trusted: Levenberg's and Marquardt's damping, which shortens
/// the steps. The model is used as long as it foretells what happens.
class TrustRegion {
 public:
  bool has_model() const { return model_.has_value(); }
  LocalModel& model() { return *model_; }
  void drop_model() { model_.reset(); }

  /// False if there are numbers in it that are not finite.
  bool set_model(RolloutJacobian jacobian) {
    model_.emplace(std::move(jacobian));
    if (!model_->is_finite()) return false;
    model_->set_damping(damping_);
    return true;
  }

  void widen() {
    if (damping_ > least_damping) set_damping(std::max(least_damping, 0.3 * damping_));
  }

  /// False where the steps are as short as they may be.
  bool narrow() {
    if (!(damping_ < most_damping)) return false;
    set_damping(10 * damping_);
    return true;
  }

  /// Short steps for a landing, from the model if it is of this very flight, else from a new one.
  void prepare_landing() {
    damping_ = std::max(damping_, landing_damping);
    if (model_->is_fresh()) {
      model_->set_damping(damping_);
    } else {
      model_.reset();
    }
  }

 private:
  static constexpr double least_damping = 1e-3, landing_damping = 1, most_damping = 1e3;

  void set_damping(double damping) {
    damping_ = damping;
    model_->set_damping(damping_);
  }

  std::optional<LocalModel> model_;
  double damping_ = least_damping;
};

}  // namespace nuno
