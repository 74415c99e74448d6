#include <nuno/refine.h>

#include <fmt/format.h>

#include <Eigen/QR>
#include <chrono>
#include <cmath>

namespace nuno {

RefineSummary refine(const Problem& problem, const Gains& gains, const MakeBackend& make,
                     const MakeBackend& model, const RefineOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  const Index particles = problem.chain.particles();
  Problem aimed = problem;
  if (aimed.aim_offset.size() == 0) aimed.aim_offset = Points::Zero(2, particles);

  RefineSummary summary;
  summary.aim_offset = aimed.aim_offset;
  summary.flight = rollout(*make(aimed), gains);
  summary.rollouts = 1;
  summary.error_before = summary.flight.error.mean;
  summary.reason = fmt::format("{} rounds were not enough", options.rounds);

  const double near_enough = options.tolerance * problem.chain.length;
  double lambda = 1e-1;  // over the tangent's size
  for (Index round = 0; round < options.rounds; ++round) {
    if (summary.flight.error.mean <= near_enough) break;
    if (summary.flight.status == RolloutStatus::diverged) {
      summary.reason = "the flight diverged";
      break;
    }
    aimed.aim_offset = summary.aim_offset;
    const Eigen::MatrixXd tangent = model(aimed)->arrival_tangent(gains);
    ++summary.tangents;
    if (!tangent.allFinite()) {
      summary.reason = "the tangent is not finite";
      break;
    }
    const Points miss = problem.target - summary.flight.final;
    const double size = tangent.colwise().norm().maxCoeff();
    // [tangent; λ] δ = [miss; 0] in the least squares: the normal equations would square the
    // condition, and tension's part of the tangent is small.
    Eigen::MatrixXd rows(2 * tangent.rows(), tangent.cols());
    rows.topRows(tangent.rows()) = tangent;
    Vector right = Vector::Zero(rows.rows());
    right.head(tangent.rows()) = miss.reshaped();

    const double before = miss.norm();
    double after = before;
    for (int attempt = 0; attempt < 8; ++attempt) {
      rows.bottomRows(tangent.cols()).setZero();
      rows.bottomRows(tangent.cols()).diagonal().setConstant(lambda * size);
      const Vector step = rows.householderQr().solve(right);
      aimed.aim_offset = summary.aim_offset + step.reshaped(2, particles);
      Rollout flight = rollout(*make(aimed), gains);
      ++summary.rollouts;
      after = (problem.target - flight.final).norm();
      if (after < before) {
        summary.flight = std::move(flight);
        summary.aim_offset = aimed.aim_offset;
        lambda = std::max(1e-9, 0.1 * lambda);
        break;
      }
      lambda *= 10;
    }
    if (!(after < (1 - options.least_gain) * before)) {
      summary.reason = "no offset brings it nearer";
      break;
    }
  }
  summary.converged = summary.flight.error.mean <= near_enough;
  if (summary.converged) summary.reason = "arrived within the tolerance";
  summary.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return summary;
}

}  // namespace nuno
