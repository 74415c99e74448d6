#include "instruction_sets.h"

#include <hwy/targets.h>

#include "chain_kernel.h"

namespace nuno::bench {

std::vector<InstructionSet> instruction_sets() {
  hwy::DisableTargets(0);
  std::vector<InstructionSet> result;
  std::int64_t better = 0;
  for (std::int64_t left = hwy::SupportedTargets(); left != 0; left &= left - 1) {
    hwy::DisableTargets(better);
    const std::string name = native::instruction_set();
    if (result.empty() || result.back().name != name) result.push_back({name, better});
    better |= left & -left;
  }
  hwy::DisableTargets(0);
  return result;
}

void use(const InstructionSet& instruction_set) { hwy::DisableTargets(instruction_set.better); }

}  // namespace nuno::bench
