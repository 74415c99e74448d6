#include <nuno/gains.h>

#include <nuno/mesh_fault.h>
#include <nuno/problem.h>
#include <nuno/sheet_modes.h>

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

Index fewest_sheet_particles(Index groups) {
  assert(groups >= 1 && groups <= most_groups);
  // One mode more, to see where the eigenvalue grows, and the one of the place.
  return groups == 1 ? smallest_particles
                     : last_modes_of_sheet_group[static_cast<std::size_t>(groups - 2)].last + 2;
}

namespace {

/// The last mode of a group, counted from 1, see ModeRange. Of factors that are alike the first,
/// whatever their rounding.
Index last_mode(const Vector& eigenvalues, const ModeRange& range) {
  const auto growth = [&](Index mode) { return eigenvalues[mode] / eigenvalues[mode - 1]; };
  double largest = 0;
  for (Index mode = range.first; mode <= range.last; ++mode) {
    largest = std::max(largest, growth(mode));
  }
  constexpr double alike = 1e-6;
  Index mode = range.first;
  while (growth(mode) < (1 - alike) * largest) ++mode;
  return mode;
}

}  // namespace

LowModes::LowModes(const Problem& problem, Index groups)
    : LowModes(problem.cloth().particles(), problem.is_sheet() ? 1 : groups) {
  if (!problem.is_sheet() || groups == 1) return;
  const Sheet& sheet = problem.sheet();
  assert(sheet.particles() >= fewest_sheet_particles(groups));
  const auto bounds =
      std::span(last_modes_of_sheet_group).first(static_cast<std::size_t>(groups - 1));
  const SheetModes modes = sheet_modes(sheet, bounds.back().last + 1);
  for (const ModeRange& range : bounds) {
    group.resize(static_cast<std::size_t>(last_mode(modes.eigenvalues, range)),
                 &range - bounds.data());
  }
  shapes = modes.shapes.topRows(static_cast<Index>(group.size()));
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
