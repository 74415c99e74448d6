#include "trust_region.h"

namespace nuno {

LocalModel::LocalModel(RolloutJacobian jacobian)
    : jacobian_(std::move(jacobian)),
      hessian_(Eigen::MatrixXd::Zero(jacobian_.arrival.cols(), jacobian_.arrival.cols())),
      path_(Vector::Zero(jacobian_.arrival.cols())) {
  hessian_.selfadjointView<Eigen::Lower>().rankUpdate(jacobian_.forces_jacobian.transpose());
}

void LocalModel::set_damping(double damping) {
  Eigen::MatrixXd damped = hessian_;
  damped.diagonal().array() += damping * damping * hessian_.diagonal().maxCoeff();
  factor_.compute(damped);
  across_ = factor_.solve(jacobian_.arrival.transpose());
  reach_ = jacobian_.arrival * across_;
}

Vector LocalModel::step(const Vector& residual, double weight) const {
  const Vector down = factor_.solve(jacobian_.forces_jacobian.transpose() * forces(path_));
  Eigen::MatrixXd system = reach_;
  system.diagonal().array() += 1 / (weight * weight);
  const Vector pull = system.ldlt().solve(residual + jacobian_.arrival * down);
  return across_ * pull - down;
}

Vector LocalModel::landing(const Vector& residual) const {
  constexpr double rounding = 1e-14;  // no offset moves the centroid
  Eigen::MatrixXd system = reach_;
  system.diagonal().array() += rounding * reach_.diagonal().maxCoeff();
  return across_ * system.ldlt().solve(residual);
}

double LocalModel::predicted_reduction(const Vector& residual, double weight,
                                       const Vector& step) const {
  const auto cost = [&](const Vector& path, const Vector& left) {
    return forces(path).squaredNorm() + weight * weight * left.squaredNorm();
  };
  return cost(path_, residual) - cost(path_ + step, residual - jacobian_.arrival * step);
}

}  // namespace nuno
