#include "rollout_gains.h"

#include <cassert>

namespace nuno::native {

RolloutGains RolloutGains::part(Index first, Index count) const {
  const auto at = [](Index index) { return static_cast<std::size_t>(index); };
  RolloutGains result = *this;
  result.values = values.subspan(at(first * groups()), at(count * groups()));
  if (!seeds.empty()) result.seeds = seeds.subspan(at(first), at(count));
  return result;
}

GroupedRollouts::GroupedRollouts(const Backend& backend, std::span<const Gains> gains,
                                 Index copies) {
  if (gains.empty()) return;
  const Index groups = gains.front().count();
  if (groups > 1) modes_ = &backend.low_modes(groups);
  for (const Gains& each : gains) {
    assert(each.count() == groups);
    for (Index copy = 0; copy < copies; ++copy) {
      values_.insert(values_.end(), each.low.begin(), each.low.end());
      values_.push_back(each.rest);
      seeds_.push_back(copy);
    }
  }
}

}  // namespace nuno::native
