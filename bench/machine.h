#pragma once

#include <string>
#include <vector>

namespace nuno::bench {

struct Machine {
  std::string cpu;
  int cores = 0;
  std::string instruction_set;  ///< the native chain's
  std::string compiler;
  double load = 0;  ///< processes that wanted a core in the last minute, this one included
};
Machine describe_machine();

/// Holds the process, with every thread that it starts, on `count` of its cores while it lives.
class OnCores {
 public:
  explicit OnCores(int count);
  ~OnCores();
  OnCores(const OnCores&) = delete;
  OnCores& operator=(const OnCores&) = delete;

 private:
  std::vector<int> before_;
};

/// Cores that this process may use.
int usable_cores();

/// Memory in use now, and the most since `reset_peak_memory` [bytes]; NaN where the system does not
/// say.
double memory_in_use();
double peak_memory();
void reset_peak_memory();

}  // namespace nuno::bench
