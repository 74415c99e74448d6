#include "gain_range.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace nuno {

double swing_speed(const Objective& objective, double gain, const ErrorSample& sample) {
  if (!std::isfinite(sample.error)) return std::numeric_limits<double>::infinity();
  const double by_phase = 2 * std::sqrt(gain * objective.gain_scale);  // dα/dφ
  const double speed =
      by_phase * sample.derivatives.front().residual.colwise().norm().mean() / objective.size;
  return std::isfinite(speed) ? speed : std::numeric_limits<double>::infinity();
}

namespace {

/// For each gain whether E is noise there; by values, from a second flight a bit farther.
std::vector<bool> are_noise(const Objective& objective, std::span<const double> gains) {
  std::vector<bool> noise;
  if (objective.samples) {
    const std::vector<ErrorSample> samples = objective.samples(gains);
    for (std::size_t i = 0; i < gains.size(); ++i) {
      noise.push_back(swing_speed(objective, gains[i], samples[i]) > 1);
    }
    return noise;
  }
  constexpr double delta = 1e-3;  // of phase
  std::vector<double> pairs(gains.begin(), gains.end());
  for (const double gain : gains) {
    pairs.push_back(std::pow(std::sqrt(gain) + delta * std::sqrt(objective.gain_scale), 2));
  }
  const std::vector<double> errors = objective.errors(pairs);
  for (std::size_t i = 0; i < gains.size(); ++i) {
    noise.push_back(!(std::abs(errors[i + gains.size()] - errors[i]) <= delta * objective.size));
  }
  return noise;
}

}  // namespace

GainRange gain_range(const Objective& objective, double largest) {
  const double scale = objective.gain_scale;
  GainRange range;
  range.calm = range.largest = std::min(largest * scale, objective.largest_gain);
  range.why = range.largest < objective.largest_gain
                  ? "the search ends there"
                  : "the time step resolves no larger one; a shorter step does";
  const double calm = calm_gain_scales * scale;
  if (!swings(objective) || range.largest <= calm) return range;
  constexpr int count = 8;
  std::vector<double> gains;
  for (int i = 1; i <= count; ++i) {
    gains.push_back(calm * std::pow(range.largest / calm, static_cast<double>(i) / count));
  }
  const std::vector<bool> noise = are_noise(objective, gains);
  range.evaluations = objective.samples ? count : 2 * count;
  // One alone may be a fold on the way.
  const std::array two_in_a_row = {true, true};
  const auto begin =
      std::search(noise.begin(), noise.end(), two_in_a_row.begin(), two_in_a_row.end());
  if (begin == noise.end()) return range;
  const auto first = static_cast<std::size_t>(begin - noise.begin());
  range.calm = first == 0 ? calm : gains[first - 1];
  range.largest = gains[first];
  range.why =
      "beyond, E of a control without damping is noise; \"damping_ratio\": 0.7 takes it farther";
  return range;
}

}  // namespace nuno
