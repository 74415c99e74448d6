#include "derivative_search.h"

#include "gain_range.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <list>
#include <utility>
#include <vector>
// Boost 1.74's header needs it and does not include it.
#include <boost/math/tools/minima.hpp>
#include <cstdint>

namespace nuno {
namespace {

/// One gain on the axis u = √α, along which the arrival swings evenly.
struct Knot {
  double u = 0;
  double speed = 0;    ///< see swing_speed
  ErrorSample sample;  ///< of error ∞ where the flight diverged or E is noise

  bool known() const { return std::isfinite(sample.error); }
};

/// Between two knots every particle arrives on a smooth path, taken for the cubic through its ends
/// and their derivatives. E, the mean distance from the target, is not so smooth, and is read off
/// those paths.
struct Bracket {
  const Knot* left;
  const Knot* right;
  int halvings = 0;        ///< left, of paths that no cubic knows; at 0, the cubic is believed
  double minimum = 0;      ///< where the error on the paths is least [u]; to halve: the middle
  double prediction = 0;   ///< that error [m]
  double lower_bound = 0;  ///< the prediction less what the last one nearby was off [m]

  /// Of paths that no cubic knows yet.
  static Bracket to_halve(const Knot& from, const Knot& to, int halvings) {
    return {&from, &to, halvings, 0.5 * (from.u + to.u)};
  }
  static Bracket of_cubics(const Knot& from, const Knot& to, double model_error);

  double width() const { return right->u - left->u; }
  double error_at(double s) const;  ///< on the cubics, s from 0 to 1
};

Bracket Bracket::of_cubics(const Knot& from, const Knot& to, double model_error) {
  Bracket bracket{&from, &to};
  constexpr int cells = 8;
  double least = std::numeric_limits<double>::infinity();
  int cell = 0;
  for (int i = 0; i <= cells; ++i) {
    const double error = bracket.error_at(static_cast<double>(i) / cells);
    if (error < least) {
      least = error;
      cell = i;
    }
  }
  const double low = std::max(cell - 1, 0), high = std::min(cell + 1, cells);
  const auto [s, error] = boost::math::tools::brent_find_minima(
      [&bracket](double at) { return bracket.error_at(at); }, low / cells, high / cells, 14);
  bracket.minimum = std::lerp(from.u, to.u, std::clamp(s, 1e-4, 1 - 1e-4));
  bracket.prediction = error;
  bracket.lower_bound = error - model_error;
  return bracket;
}

double Bracket::error_at(double s) const {
  const double t = 1 - s;
  const double from = t * t * (1 + 2 * s), to = s * s * (1 + 2 * t);
  // d/du = 2u·d/dα
  const double leaving = 2 * left->u * s * t * t * width();
  const double arriving = -2 * right->u * s * s * t * width();
  return (from * left->sample.residual + to * right->sample.residual +
          leaving * left->sample.derivatives.front().residual +
          arriving * right->sample.derivatives.front().residual)
      .colwise()
      .norm()
      .mean();
}

class DerivativeSearch {
 public:
  DerivativeSearch(const Objective& objective, const GlobalSearchOptions& options,
                   OptimizeSummary& summary)
      : objective_(objective), options_(options), summary_(summary) {}

  void scan(std::span<const double> gains) {
    const std::vector<const Knot*> knots = fly(gains);
    for (std::size_t i = 1; i < knots.size(); ++i) {
      add_bracket(*knots[i - 1], *knots[i], swings(objective_) ? most_halvings : 0, 0);
    }
  }

  bool done() const {
    const double wanted = std::max(best_ * (1 - options_.error_tolerance), objective_.negligible);
    return best_ <= objective_.negligible || std::ranges::none_of(brackets_, [&](const Bracket& b) {
             return b.lower_bound <= wanted;
           });
  }

  /// Splits the brackets that no cubic knows and, in lanes that would fly empty, those whose lower
  /// bound is least.
  void refine() {
    std::ranges::sort(brackets_, {},
                      [](const Bracket& b) { return std::pair(b.halvings == 0, b.lower_bound); });
    const auto unknown = static_cast<Index>(
        std::ranges::count_if(brackets_, [](const Bracket& b) { return b.halvings > 0; }));
    const Index batches = std::max<Index>(1, (unknown + options_.brackets - 1) / options_.brackets);
    const std::size_t count =
        std::min(brackets_.size(), static_cast<std::size_t>(batches * options_.brackets));
    const auto rest = brackets_.begin() + static_cast<std::ptrdiff_t>(count);
    const std::vector<Bracket> split(brackets_.begin(), rest);
    brackets_.erase(brackets_.begin(), rest);
    std::vector<double> gains;
    gains.reserve(count);
    for (const Bracket& bracket : split) gains.push_back(std::pow(bracket.minimum, 2));
    const std::vector<const Knot*> found = fly(gains);
    for (std::size_t i = 0; i < count; ++i) {
      const Bracket& bracket = split[i];
      const bool predicted = bracket.halvings == 0;
      const double model_error =
          predicted ? 0.5 * std::abs(found[i]->sample.error - bracket.prediction) : 0;
      const int halvings = predicted ? 0 : bracket.halvings - 1;
      add_bracket(*bracket.left, *found[i], halvings, model_error);
      add_bracket(*found[i], *bracket.right, halvings, model_error);
    }
  }

 private:
  static constexpr int most_halvings = 3;

  std::vector<const Knot*> fly(std::span<const double> gains) {
    const double calm =
        swings(objective_) ? calm_gain_scales * objective_.gain_scale : objective_.largest_gain;
    std::vector<ErrorSample> samples = objective_.samples(gains);
    summary_.evaluations += static_cast<Index>(gains.size());
    std::vector<const Knot*> found;
    for (std::size_t i = 0; i < gains.size(); ++i) {
      const double speed = swing_speed(objective_, gains[i], samples[i]);
      if (gains[i] > calm && speed > 1) {
        samples[i].error = std::numeric_limits<double>::infinity();
      } else {
        summary_.history.push_back({gains[i], samples[i].error});
      }
      best_ = std::min(best_, samples[i].error);
      knots_.push_back({std::sqrt(gains[i]), speed, std::move(samples[i])});
      found.push_back(&knots_.back());
    }
    return found;
  }

  void add_bracket(const Knot& left, const Knot& right, int halvings, double model_error) {
    constexpr double farthest = 0.25;  // that the arrival may move between, over L
    if (right.u - left.u < options_.gain_tolerance * right.u) return;
    const double phase = (right.u - left.u) / std::sqrt(objective_.gain_scale);
    const bool far = phase * std::max(left.speed, right.speed) > farthest;
    if (far && halvings > 0 && (left.known() || right.known())) {
      brackets_.push_back(Bracket::to_halve(left, right, halvings));
    } else if (left.u > 0 && left.known() && right.known()) {
      // From gain 0 on, the derivative along u of damped control is not u's own.
      brackets_.push_back(Bracket::of_cubics(left, right, model_error));
    }
  }

  const Objective& objective_;
  const GlobalSearchOptions& options_;
  OptimizeSummary& summary_;
  double best_ = std::numeric_limits<double>::infinity();
  std::list<Knot> knots_;  ///< brackets point to them
  std::vector<Bracket> brackets_;
};

}  // namespace

bool search_with_derivatives(const Objective& objective, std::span<const double> gains,
                             const GlobalSearchOptions& options, OptimizeSummary& summary) {
  DerivativeSearch search(objective, options, summary);
  search.scan(gains);
  for (Index round = 0; round < options.rounds && !search.done(); ++round) search.refine();
  return search.done();
}

}  // namespace nuno
