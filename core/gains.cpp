#include <nuno/gains.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

namespace nuno {

Gains Gains::of_groups(std::span<const double> groups) {
  assert(!groups.empty() && static_cast<Index>(groups.size()) <= most_groups);
  Gains gains(groups.back());
  gains.low.assign(groups.begin(), groups.end() - 1);
  return gains;
}

std::vector<double> Gains::groups() const {
  std::vector<double> result = low;
  result.push_back(rest);
  return result;
}

double Gains::largest() const {
  double result = rest;
  for (const double gain : low) result = std::max(result, gain);
  return result;
}

Gains Gains::split(Index count) const {
  assert(count >= this->count());
  Gains result = *this;
  result.low.resize(static_cast<std::size_t>(count - 1), rest);
  return result;
}

Index fewest_particles(Index groups) {
  assert(groups >= 1 && groups <= most_groups);
  return groups == 1 ? 2 : last_mode_of_group[static_cast<std::size_t>(groups - 2)] + 2;
}

LowModes::LowModes(Index particles, Index groups) {
  assert(particles >= fewest_particles(groups));
  for (Index k = 0; k + 1 < groups; ++k) {
    group.resize(static_cast<std::size_t>(last_mode_of_group[static_cast<std::size_t>(k)]), k);
  }
  shapes.resize(static_cast<Index>(group.size()), particles);
  const auto n = static_cast<double>(particles);
  for (Index j = 0; j < shapes.rows(); ++j) {
    const double rate = std::numbers::pi * static_cast<double>(j + 1) / n;
    for (Index i = 0; i < particles; ++i) {
      shapes(j, i) = std::sqrt(2 / n) * std::cos(rate * (static_cast<double>(i) + 0.5));
    }
  }
}

}  // namespace nuno
