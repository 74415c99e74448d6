#include "machine.h"

#include <malloc.h>
#include <sched.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <limits>
#include <thread>

#include "chain_kernel.h"

namespace nuno::bench {
namespace {

std::string value_in(const char* path, const std::string& key) {
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    if (!line.starts_with(key)) continue;
    const std::size_t value = line.find_first_not_of(" \t:", key.size());
    return value == std::string::npos ? "" : line.substr(value);
  }
  return "";
}

std::vector<int> allowed() {
  cpu_set_t set;
  CPU_ZERO(&set);
  sched_getaffinity(0, sizeof set, &set);
  std::vector<int> cores;
  for (int core = 0; core < CPU_SETSIZE; ++core) {
    if (CPU_ISSET(static_cast<std::size_t>(core), &set)) cores.push_back(core);
  }
  return cores;
}

void allow(const std::vector<int>& cores) {
  cpu_set_t set;
  CPU_ZERO(&set);
  for (const int core : cores) CPU_SET(static_cast<std::size_t>(core), &set);
  sched_setaffinity(0, sizeof set, &set);
}

double kilobytes(const std::string& key) {
  const std::string value = value_in("/proc/self/status", key);
  return value.empty() ? std::numeric_limits<double>::quiet_NaN()
                       : 1024 * std::strtod(value.c_str(), nullptr);
}

}  // namespace

Machine describe_machine() {
  Machine machine;
  machine.cpu = value_in("/proc/cpuinfo", "model name");
  machine.cores = usable_cores();
  machine.instruction_set = native::instruction_set();
#ifdef __clang__
  machine.compiler = __VERSION__;
#else
  machine.compiler = "GCC " __VERSION__;
#endif
  double load[1] = {std::numeric_limits<double>::quiet_NaN()};
  if (getloadavg(load, 1) == 1) machine.load = load[0];
  return machine;
}

OnCores::OnCores(int count) : before_(allowed()) {
  if (static_cast<std::size_t>(count) < before_.size()) {
    allow({before_.begin(), before_.begin() + count});
  }
}
OnCores::~OnCores() { allow(before_); }

int usable_cores() { return static_cast<int>(allowed().size()); }

double memory_in_use() {
  malloc_trim(0);
  return kilobytes("VmRSS");
}
double peak_memory() { return kilobytes("VmHWM"); }
void reset_peak_memory() { std::ofstream("/proc/self/clear_refs") << "5"; }

}  // namespace nuno::bench
