#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace nuno::bench {

/// An instruction set that the native chain was compiled for and this machine has.
struct InstructionSet {
  std::string name;
  std::int64_t better = 0;  ///< Highway's bits of those that it prefers
};

/// The preferred one first.
std::vector<InstructionSet> instruction_sets();

/// From now on the native chain uses this one.
void use(const InstructionSet& instruction_set);

}  // namespace nuno::bench
