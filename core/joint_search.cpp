#include <nuno/joint_search.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <chrono>
#include <cmath>

namespace nuno {
namespace {

/// The objective on the axes x = log α of the groups, within bounds, counted.
class LogObjective {
 public:
  /// The best single gain, `start` [N/m], is within the bounds as well.
  LogObjective(const JointObjective& objective, const JointSearchOptions& options, double start)
      : objective_(objective),
        largest_gain_(std::max(objective.largest_gain, start)),
        lowest_(std::log(options.smallest_gain * objective.gain_scale)),
        highest_(std::max(lowest_, std::log(largest_gain_))) {}

  struct Point {
    Vector x;
    double error = 0;
    Vector derivative;  ///< dE/dx
  };

  Gains gains(const Vector& x) const {
    std::vector<double> groups;
    for (const double each : x) groups.push_back(std::min(std::exp(each), largest_gain_));
    return Gains::of_groups(groups);
  }
  Vector place(const Gains& gains) const {
    const std::vector<double> groups = gains.groups();
    Vector x(gains.count());
    for (Index k = 0; k < x.size(); ++k) {
      x[k] = std::log(groups[static_cast<std::size_t>(k)]);
    }
    return within(x);
  }
  Vector within(const Vector& x) const { return x.cwiseMax(lowest_).cwiseMin(highest_); }

  /// Whether a bound keeps x from going on against its derivative.
  bool is_held(double x, double derivative) const {
    return (x <= lowest_ && derivative > 0) || (x >= highest_ && derivative < 0);
  }

  std::vector<double> errors(const std::vector<Vector>& places) {
    std::vector<Gains> all;
    all.reserve(places.size());
    for (const Vector& x : places) all.push_back(gains(x));
    evaluations_ += static_cast<Index>(all.size());
    return objective_.errors(all);
  }

  Point at(const Vector& x) {
    Point point{x, 0, Vector(x.size())};
    if (objective_.samples) {
      evaluations_ += x.size();
      const Gains here = gains(x);
      const ErrorSample found = objective_.samples({&here, 1}).front();
      point.error = found.error;
      for (Index k = 0; k < x.size(); ++k) {
        point.derivative[k] = std::exp(x[k]) * found.derivatives[static_cast<std::size_t>(k)].error;
      }
      return point;
    }
    // Central differences, so wide that the rounding of single precision does not show.
    constexpr double delta = 0.01;
    std::vector<Vector> around = {x};
    for (Index k = 0; k < x.size(); ++k) {
      for (const double side : {-delta, delta}) {
        Vector beside = x;
        beside[k] += side;
        around.push_back(within(beside));
      }
    }
    const std::vector<double> found = errors(around);
    point.error = found.front();
    for (Index k = 0; k < x.size(); ++k) {
      const auto behind = static_cast<std::size_t>(2 * k + 1);
      point.derivative[k] =
          (found[behind + 1] - found[behind]) / (around[behind + 1][k] - around[behind][k]);
    }
    return point;
  }

  Index evaluations() const { return evaluations_; }

 private:
  const JointObjective& objective_;
  double largest_gain_;
  double lowest_, highest_;
  Index evaluations_ = 0;
};

using Point = LogObjective::Point;

/// The inverse of the Hessian that BFGS has learnt.
class InverseHessian {
 public:
  bool is_known() const { return matrix_.size() > 0; }
  void forget() { matrix_.resize(0, 0); }

  /// −H·derivative on the axes that no bound holds; the steepest descent of length ½ until a step
  /// is known.
  Vector direction(const LogObjective& objective, const Point& at) const {
    Vector derivative = at.derivative;
    for (Index k = 0; k < derivative.size(); ++k) {
      if (objective.is_held(at.x[k], derivative[k])) derivative[k] = 0;
    }
    Vector result = -derivative;
    if (is_known()) {
      result = -(matrix_ * derivative);
      for (Index k = 0; k < derivative.size(); ++k) {
        if (derivative[k] == 0) result[k] = 0;
      }
    }
    constexpr double first_move = 0.5, largest_move = 2;  // in log α
    const double size = result.norm();
    if (!(size > 0)) return Vector::Zero(derivative.size());
    if (!is_known()) return first_move / size * result;
    return std::min(1.0, largest_move / size) * result;
  }

  void learn(const Point& from, const Point& to) {
    const Vector step = to.x - from.x;
    const Vector change = to.derivative - from.derivative;
    const double curvature = step.dot(change);
    if (!(curvature > 1e-8 * step.norm() * change.norm())) return;
    const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(step.size(), step.size());
    if (!is_known()) matrix_ = curvature / change.squaredNorm() * one;
    const Eigen::MatrixXd shear = one - step * change.transpose() / curvature;
    matrix_ = shear * matrix_ * shear.transpose() + step * step.transpose() / curvature;
  }

 private:
  Eigen::MatrixXd matrix_;
};

/// Goes down from x; false if it ran out of rounds.
bool descend(LogObjective& objective, const JointSearchOptions& options, const Vector& start,
             Point& best) {
  // One batch: the step that BFGS expects, and others should it be wrong.
  constexpr std::array<double, 8> lengths = {1, 2, 4, 0.5, 0.2, 0.05, 0.01, 1e-3};
  Point here = objective.at(start);
  InverseHessian hessian;
  bool out_of_rounds = true;
  for (Index round = 0; round < options.rounds; ++round) {
    out_of_rounds = false;
    if (!std::isfinite(here.error) || !here.derivative.allFinite()) break;
    const Vector direction = hessian.direction(objective, here);
    if (direction.isZero(0)) break;
    std::vector<Vector> places;
    places.reserve(lengths.size());
    for (const double length : lengths) {
      places.push_back(objective.within(here.x + length * direction));
    }
    const std::vector<double> errors = objective.errors(places);
    const auto lowest = std::ranges::min_element(errors);
    const double gained = here.error - *lowest;
    if (gained > 0) {
      Point next = objective.at(places[static_cast<std::size_t>(lowest - errors.begin())]);
      hessian.learn(here, next);
      here = std::move(next);
    }
    if (!(gained > options.error_tolerance * here.error)) {
      if (!hessian.is_known()) break;
      hessian.forget();  // and try the steepest descent before giving up
    }
    out_of_rounds = true;
  }
  if (here.error < best.error) best = here;
  return !out_of_rounds;
}

/// Starts for the descents: the split itself, and the deepest valleys along either part's gain.
std::vector<Vector> starts_from(LogObjective& objective, const JointSearchOptions& options,
                                const Vector& split) {
  constexpr double reach = 5;  // in log α, either way
  const Index last = split.size() - 1;
  struct Valley {
    Vector x;
    double error;
  };
  std::vector<Valley> valleys;
  for (const Index part : {last - 1, last}) {
    std::vector<Vector> places;
    for (Index i = 0; i < options.scan; ++i) {
      const double along = static_cast<double>(i) / static_cast<double>(options.scan - 1);
      Vector x = split;
      x[part] += std::lerp(-reach, reach, along);
      x = objective.within(x);
      if (places.empty() || x != places.back()) places.push_back(x);
    }
    const std::vector<double> errors = objective.errors(places);
    for (std::size_t i = 0; i < places.size(); ++i) {
      const bool below_left = i == 0 || errors[i] <= errors[i - 1];
      const bool below_right = i + 1 == errors.size() || errors[i] <= errors[i + 1];
      if (below_left && below_right) valleys.push_back({places[i], errors[i]});
    }
  }
  std::ranges::sort(valleys, {}, &Valley::error);
  std::vector<Vector> starts = {split};
  for (const Valley& valley : valleys) {
    if (static_cast<Index>(starts.size()) > options.valleys) break;
    starts.push_back(valley.x);
  }
  return starts;
}

}  // namespace

JointObjective joint_objective(const Backend& backend) {
  JointObjective result;
  result.errors = [&backend](std::span<const Gains> gains) { return backend.errors(gains); };
  if (backend.has_derivatives()) {
    result.samples = [&backend](std::span<const Gains> gains) {
      return backend.error_samples(gains);
    };
  }
  const Objective range = objective(backend);
  result.gain_scale = range.gain_scale;
  result.largest_gain = gain_range(range).calm;
  result.negligible = range.negligible;
  return result;
}

JointSearchSummary joint_search(const JointObjective& objective, const Evaluation& start,
                                const JointSearchOptions& options) {
  assert(options.groups >= 1 && options.groups <= most_groups && options.scan >= 2);
  const auto begin = std::chrono::steady_clock::now();
  JointSearchSummary summary;
  summary.stages = {{start.gain, start.error}};
  summary.reason = "no gain of its own brings it nearer";
  LogObjective place(objective, options, start.gain);
  for (Index groups = 2; groups <= options.groups; ++groups) {
    JointStage stage = summary.stages.back();
    if (stage.error <= objective.negligible) break;
    const Vector split = place.place(stage.gains.split(groups));
    Point best{split, stage.error, {}};
    for (const Vector& x : starts_from(place, options, split)) {
      if (!descend(place, options, x, best)) summary.status = OptimizeStatus::budget;
    }
    if (best.error < stage.error) {
      stage = {place.gains(best.x), best.error};
      summary.reason = fmt::format("descended in {} gains together", stage.gains.count());
    }
    summary.stages.push_back(stage);
  }
  summary.evaluations = place.evaluations();
  summary.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return summary;
}

}  // namespace nuno
