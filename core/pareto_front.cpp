#include <nuno/pareto_front.h>

#include <nuno/parallel.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace nuno {
namespace {

ParetoPoint point_at(const Backend& backend, double gain,
                     const std::function<void()>& before_rollout) {
  if (before_rollout) before_rollout();
  const Rollout flight = rollout(backend, gain);
  return {gain, flight.error.mean, flight.control_effort};
}

/// Adds the best of a search, and those of it that are clearly nearer than all smaller ones: it
/// tries the bottom of a valley many times.
void add_unbeaten_gains(std::span<const Evaluation> tried, std::vector<double>& gains) {
  if (tried.empty()) return;
  constexpr double worth = 0.01;  // of the error
  std::vector<Evaluation> ascending(tried.begin(), tried.end());
  std::ranges::sort(ascending, {}, &Evaluation::gain);
  double least = std::numeric_limits<double>::infinity();
  for (const Evaluation& at : ascending) {
    if (!(at.error < (1 - worth) * least)) continue;
    least = at.error;
    gains.push_back(at.gain);
  }
  const double best = std::ranges::min_element(ascending, {}, &Evaluation::error)->gain;
  if (gains.empty() || gains.back() != best) gains.push_back(best);
}

/// Halves the gains between two points, one on either side of a limit, until they meet; gives the
/// last point that keeps the limit.
template <typename KeepsLimit>
ParetoPoint bisect(const Backend& backend, ParetoPoint inside, ParetoPoint outside,
                   KeepsLimit keeps_limit, const std::function<void()>& before_rollout) {
  constexpr int halvings = 30;
  for (int i = 0; i < halvings; ++i) {
    // In logarithms, but for a side that is launch only.
    const double gain = inside.gain > 0 && outside.gain > 0 ? std::sqrt(inside.gain * outside.gain)
                                                            : 0.5 * (inside.gain + outside.gain);
    const ParetoPoint middle = point_at(backend, gain, before_rollout);
    (keeps_limit(middle) ? inside : outside) = middle;
  }
  return inside;
}

}  // namespace

std::vector<ParetoPoint> pareto_optimal(std::vector<ParetoPoint> points) {
  std::erase_if(points, [](const ParetoPoint& point) { return !std::isfinite(point.error); });
  std::ranges::sort(points, {},
                    [](const ParetoPoint& point) { return std::pair(point.effort, point.error); });
  std::vector<ParetoPoint> curve;
  for (const ParetoPoint& point : points) {
    if (curve.empty() || point.error < curve.back().error) curve.push_back(point);
  }
  return curve;
}

std::vector<ParetoPoint> pareto_front(const Backend& backend, Index count,
                                      std::span<const Evaluation> tried,
                                      const std::function<void()>& before_rollout) {
  const Objective range = objective(backend);
  const double first = 1e-2 * range.gain_scale;
  const double last = std::max(2 * first, gain_range(range).calm);
  std::vector<double> gains = {0};
  for (Index i = 0; i < count; ++i) {
    const double along = static_cast<double>(i) / static_cast<double>(count - 1);
    gains.push_back(first * std::pow(last / first, along));
  }
  add_unbeaten_gains(tried, gains);
  std::vector<ParetoPoint> all(gains.size());
  parallel_for(static_cast<Index>(gains.size()), [&](Index i) {
    const auto at = static_cast<std::size_t>(i);
    all[at] = point_at(backend, gains[at], before_rollout);
  });
  return pareto_optimal(std::move(all));
}

std::optional<ParetoPoint> least_effort(const Backend& backend,
                                        const std::vector<ParetoPoint>& curve, double error_limit,
                                        const std::function<void()>& before_rollout) {
  const auto keeps_limit = [&](const ParetoPoint& point) { return point.error <= error_limit; };
  const auto near = std::ranges::find_if(curve, keeps_limit);
  if (near == curve.end()) return std::nullopt;
  if (near == curve.begin()) return *near;
  return bisect(backend, *near, *std::prev(near), keeps_limit, before_rollout);
}

ParetoPoint least_error(const Backend& backend, const std::vector<ParetoPoint>& curve,
                        double effort_limit, const std::function<void()>& before_rollout) {
  const auto keeps_limit = [&](const ParetoPoint& point) { return point.effort <= effort_limit; };
  const auto costly = std::ranges::find_if_not(curve, keeps_limit);
  if (costly == curve.begin()) return point_at(backend, 0, before_rollout);
  if (costly == curve.end()) return curve.back();
  const ParetoPoint cheap = *std::prev(costly);
  const ParetoPoint between = bisect(backend, cheap, *costly, keeps_limit, before_rollout);
  return between.error < cheap.error ? between : cheap;
}

}  // namespace nuno
