#include <nuno/refine.h>

#include <nuno/feasibility.h>
#include <nuno/optimize.h>
#include <nuno/reference_motion.h>

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

namespace nuno {
namespace {

// Why the work ended, for people.
constexpr const char* arrived = "arrived within the tolerance";
constexpr const char* too_much_effort = "no flight of so little effort was found";

/// Shapes to correct the reference by: cosines along the chain, of few waves where they come early
/// and must not stretch the cloth on its way, and all of them at the last, where it has to arrive.
CorrectionDirections correction_directions(Index particles) {
  constexpr std::array<Index, correction_powers.size()> most_waves = {8, 8, 16, 1'000'000};
  CorrectionDirections directions;
  std::vector<Vector> shapes;
  for (std::size_t power = 0; power < correction_powers.size(); ++power) {
    for (Index wave = 1; wave <= std::min(most_waves[power], particles - 1); ++wave) {
      for (const Index row : {0, 1}) {
        Points shape = Points::Zero(2, particles);
        for (Index i = 0; i < particles; ++i) {
          shape(row, i) = std::cos(std::numbers::pi * static_cast<double>(wave) *
                                   (static_cast<double>(i) + 0.5) / static_cast<double>(particles));
        }
        directions.powers.push_back(static_cast<Index>(power));
        shapes.emplace_back(shape.reshaped());
      }
    }
  }
  directions.shapes.resize(2 * particles, static_cast<Index>(shapes.size()));
  for (std::size_t d = 0; d < shapes.size(); ++d) {
    directions.shapes.col(static_cast<Index>(d)) = shapes[d];
  }
  return directions;
}

std::vector<Points> moved(std::vector<Points> offset, const CorrectionDirections& directions,
                          const Vector& step) {
  for (Index d = 0; d < step.size(); ++d) {
    Points& of_power =
        offset[static_cast<std::size_t>(directions.powers[static_cast<std::size_t>(d)])];
    of_power += step[d] * directions.shapes.col(d).reshaped(2, of_power.cols());
  }
  return offset;
}

/// The flight in a local model: forces F + F'Δ, positions at arrival by X'. Every step minimises
///     |F + F'(Δ + δ)|² + w²·|residual − X'δ|² + μ²·|δ|²,
/// so, with H = F'ᵀF' + μ²I and g = F'ᵀ(F + F'Δ),
///     δ = H⁻¹(X'ᵀλ − g),   (X'H⁻¹X'ᵀ + w⁻²)·λ = residual + X'H⁻¹g,
/// which stays well-conditioned as w grows and arrival becomes a condition. A landing lets the
/// forces be, g = 0, and takes away the residual with the least change to them and to the
/// correction.
class LocalModel {
 public:
  explicit LocalModel(RolloutJacobian jacobian)
      : jacobian_(std::move(jacobian)),
        hessian_(Eigen::MatrixXd::Zero(jacobian_.arrival.cols(), jacobian_.arrival.cols())),
        path_(Vector::Zero(jacobian_.arrival.cols())) {
    hessian_.selfadjointView<Eigen::Lower>().rankUpdate(jacobian_.forces_jacobian.transpose());
  }

  bool is_finite() const { return hessian_.allFinite() && jacobian_.arrival.allFinite(); }
  bool is_fresh() const { return path_.isZero(0); }

  /// `damping` is μ over the size of F'.
  void set_damping(double damping) {
    Eigen::MatrixXd damped = hessian_;
    damped.diagonal().array() += damping * damping * hessian_.diagonal().maxCoeff();
    factor_.compute(damped);
    across_ = factor_.solve(jacobian_.arrival.transpose());
    reach_ = jacobian_.arrival * across_;
  }

  Vector step(const Vector& residual, double weight) const {
    const Vector down = factor_.solve(jacobian_.forces_jacobian.transpose() * forces(path_));
    Eigen::MatrixXd system = reach_;
    system.diagonal().array() += 1 / (weight * weight);
    const Vector pull = system.ldlt().solve(residual + jacobian_.arrival * down);
    return across_ * pull - down;
  }

  Vector landing(const Vector& residual) const {
    constexpr double rounding = 1e-14;  // no offset moves the centroid
    Eigen::MatrixXd system = reach_;
    system.diagonal().array() += rounding * reach_.diagonal().maxCoeff();
    return across_ * system.ldlt().solve(residual);
  }

  /// By how much a step lets the objective fall.
  double predicted_reduction(const Vector& residual, double weight, const Vector& step) const {
    const auto cost = [&](const Vector& path, const Vector& left) {
      return forces(path).squaredNorm() + weight * weight * left.squaredNorm();
    };
    return cost(path_, residual) - cost(path_ + step, residual - jacobian_.arrival * step);
  }

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

}  // namespace

double tracking_gain(const Backend& backend) {
  // √300 = 17 rad until arrival: what the launch leaves behind has died away by then, and nothing
  // that the engines see differently grows.
  constexpr double gain_scales = 300;
  const Objective range = objective(backend);
  return std::min(gain_scales * range.gain_scale, range.largest_gain);
}

RefineSummary refine(const Problem& problem, double gain, const MakeBackend& make,
                     const MakeBackend& model, const RefineOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  const Index particles = problem.cloth().particles();
  const double length = problem.cloth().size;
  Problem corrected = problem;
  if (corrected.reference_correction.empty()) {
    corrected.reference_correction.assign(correction_powers.size(), Points::Zero(2, particles));
  }

  RefineSummary summary;
  summary.reference_correction = corrected.reference_correction;
  summary.flight = rollout(*make(corrected), gain);
  summary.rollouts = 1;
  summary.error_before = summary.flight.error.mean;
  summary.reason = fmt::format("{} rounds were not enough", options.rounds);

  const CorrectionDirections directions = correction_directions(particles);
  const auto residual_of = [&](const Rollout& flight) -> Vector {
    return (problem.target - flight.final).reshaped();
  };
  // w = weight/(L·√N): an rms error of L counts as much as an effort of `weight`.
  const double unit = 1 / (length * std::sqrt(static_cast<double>(particles)));
  const auto objective = [&](const Rollout& flight, double weight) {
    return flight.control_effort * flight.control_effort +
           std::pow(weight * unit, 2) * residual_of(flight).squaredNorm();
  };
  // An answer of before is corrected where it stands; a new one starts where effort counts.
  double weight = summary.flight.control_effort * length / summary.flight.error.mean;
  if (problem.reference_correction.empty()) {
    weight = std::min(weight, std::isfinite(options.effort_limit) ? 1.0 : 30.0);
  }
  // A cloth that is too long or too short for a segment of the target can be squeezed towards it
  // without end; there, an error of 1e-4·L is worth a particle's weight and no more.
  constexpr double reachable_mismatch = 1e-6;
  const bool within_reach = assess(*make(corrected)).length_mismatch <= reachable_mismatch;
  const double largest_weight = within_reach || std::isfinite(options.effort_limit)
                                    ? std::numeric_limits<double>::infinity()
                                    : 1e4;
  double growth = 4;
  constexpr double least_damping = 1e-3, landing_damping = 1, most_damping = 1e3;
  double damping = least_damping;
  // Where the jacobian no longer foretells what effort can be spared, little of it is left to
  // spare; from near enough, the cloth lands.
  bool landing = false;
  constexpr double least_stride = 1e-2;
  double stride = 1;  // of the way to land
  double landing_error = within_reach && !std::isfinite(options.effort_limit) ? 1e-3 * length : 0;
  std::optional<LocalModel> near;
  for (Index round = 0; round < options.rounds; ++round) {
    if (summary.flight.error.mean <= options.tolerance * length) break;
    if (summary.flight.status == RolloutStatus::diverged) {
      summary.reason = "the flight diverged";
      break;
    }
    if (weight > largest_weight) {
      summary.reason =
          "the cloth's segments do not fit the target's; this is as near as is worth it";
      break;
    }
    if (!near) {
      corrected.reference_correction = summary.reference_correction;
      near.emplace(model(corrected)->jacobian(gain, directions));
      ++summary.jacobians;
      if (!near->is_finite()) {
        summary.reason = "the jacobian is not finite";
        break;
      }
      near->set_damping(damping);
    }
    const Vector residual = residual_of(summary.flight);
    const Vector step =
        landing ? Vector(stride * near->landing(residual)) : near->step(residual, weight * unit);
    corrected.reference_correction = moved(summary.reference_correction, directions, step);
    Rollout flight = rollout(*make(corrected), gain);
    ++summary.rollouts;
    const auto accept = [&] {
      near->go(step);
      summary.flight = std::move(flight);
      summary.reference_correction = corrected.reference_correction;
    };
    if (landing) {
      const double left = flight.error.mean / summary.flight.error.mean;
      const bool nearer = left < 1 - 0.3 * stride;
      const bool fresh = near->is_fresh();
      if (nearer) accept();
      if (left < 0.25) continue;
      if (nearer || !fresh) {
        near.reset();
        stride = std::min(1.0, 4 * stride);
      } else if (stride > least_stride) {
        stride /= 4;
      } else {
        landing = false;
        landing_error = 0.3 * summary.flight.error.mean;
      }
      continue;
    }
    const double kept = (objective(summary.flight, weight) - objective(flight, weight)) /
                        near->predicted_reduction(residual, weight * unit, step);
    if (kept > 0.1) {
      const bool within = summary.flight.control_effort <= options.effort_limit;
      if (within && flight.control_effort > options.effort_limit) {
        if (growth < 1.05) {
          summary.reason = "more would take more effort than the limit";
          break;
        }
        weight /= growth;
        growth = std::sqrt(growth);
        weight *= growth;
        continue;
      }
      accept();
      if (within || summary.flight.control_effort <= options.effort_limit) weight *= growth;
      if (kept < 0.5) {
        near.reset();
      } else if (damping > least_damping) {
        near->set_damping(damping = std::max(least_damping, 0.3 * damping));
      }
    } else if (summary.flight.error.mean < landing_error) {
      landing = true;
      damping = std::max(damping, landing_damping);
      if (near->is_fresh()) {
        near->set_damping(damping);
      } else {
        near.reset();
      }
    } else if (!near->is_fresh()) {
      near.reset();
    } else if (damping < most_damping) {
      near->set_damping(damping *= 10);
    } else {
      summary.reason = "no offset brings it nearer";
      break;
    }
  }
  summary.converged = summary.flight.error.mean <= options.tolerance * length;
  if (summary.converged) summary.reason = arrived;
  if (summary.flight.control_effort > options.effort_limit) {
    summary.converged = false;
    summary.reason = too_much_effort;
  }
  summary.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return summary;
}

RefineSummary transfer(const Problem& problem, const RefineSummary& answer, const MakeBackend& make,
                       const MakeBackend& model, const RefineOptions& options) {
  constexpr double single_precision = 1e-5;
  constexpr Index rounds = 4;
  const auto start = std::chrono::steady_clock::now();
  const double tolerance = std::max(options.tolerance, single_precision);
  const double gain = answer.flight.gains.rest;
  Problem corrected = problem;
  corrected.reference_correction = answer.reference_correction;
  RefineSummary transferred = answer;
  transferred.flight = rollout(*make(corrected), gain);
  transferred.error_before = rollout(*make(problem), gain).error.mean;
  transferred.rollouts += 2;
  transferred.converged = transferred.flight.error.mean <= tolerance * problem.cloth().size;
  if (transferred.converged) {
    transferred.reason = arrived;
  } else if (std::isfinite(options.effort_limit)) {
    // Steps towards the target would leave the Pareto front that the limit asked for.
    transferred.reason = "the limit's point of the Pareto front, as it was found";
  } else {
    const RefineSummary nearer =
        refine(corrected, gain, make, model, {.tolerance = tolerance, .rounds = rounds});
    transferred.rollouts += nearer.rollouts;
    transferred.jacobians += nearer.jacobians;
    if (nearer.flight.error.mean < transferred.flight.error.mean) {
      transferred.flight = nearer.flight;
      transferred.reference_correction = nearer.reference_correction;
      transferred.converged = nearer.converged;
    }
    transferred.reason = nearer.reason;
  }
  if (transferred.flight.control_effort > options.effort_limit) {
    transferred.converged = false;
    transferred.reason = too_much_effort;
  }
  transferred.seconds +=
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return transferred;
}

}  // namespace nuno
