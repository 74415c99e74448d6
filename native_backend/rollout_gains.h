#pragma once

#include <nuno/backend.h>

#include <span>
#include <vector>

namespace nuno::native {

/// The gains of several flights.
struct RolloutGains {
  std::span<const double> values;  ///< of every group [groups × flights], a flight after another
  const LowModes* low_modes = nullptr;  ///< of all groups but the last; null: there is but one
  /// The group with respect to whose gain a flight's derivatives are taken; empty: the first for
  /// all.
  std::span<const Index> seeds = {};

  Index groups() const { return low_modes == nullptr ? 1 : low_modes->group.back() + 2; }
  Index flights() const { return static_cast<Index>(values.size()) / groups(); }
  double value(Index flight, Index group) const {
    return values[static_cast<std::size_t>(flight * groups() + group)];
  }
  Index seed(Index flight) const {
    return seeds.empty() ? 0 : seeds[static_cast<std::size_t>(flight)];
  }
  RolloutGains part(Index first, Index count) const;
};

/// Gains by group in that layout: each of them `copies` times, with the derivative by another group
/// each time.
class GroupedRollouts {
 public:
  GroupedRollouts(const Backend& backend, std::span<const Gains> gains, Index copies);
  /// They last as long as this does and the backend.
  RolloutGains gains() const { return {values_, modes_, seeds_}; }

 private:
  const LowModes* modes_ = nullptr;
  std::vector<double> values_;
  std::vector<Index> seeds_;
};

}  // namespace nuno::native
