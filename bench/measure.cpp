#include "measure.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <ctime>
#include <optional>

namespace nuno::bench {

Statistics statistics(std::vector<double> values) {
  assert(!values.empty());
  std::ranges::sort(values);
  const std::size_t middle = values.size() / 2;
  const double median =
      values.size() % 2 == 1 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
  return {median, values.front(), values.back()};
}

Statistics exactly(double value) { return {value, value, value}; }

Statistics scaled(const Statistics& statistics, double factor) {
  return {statistics.median * factor, statistics.min * factor, statistics.max * factor};
}

Statistics ratio(std::span<const double> a, std::span<const double> b) {
  assert(a.size() == b.size());
  std::vector<double> quotients;
  for (std::size_t i = 0; i < a.size(); ++i) quotients.push_back(a[i] / b[i]);
  return statistics(std::move(quotients));
}

double seconds(Clock clock) {
  std::timespec time{};
  clock_gettime(clock == Clock::wall ? CLOCK_MONOTONIC : CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

std::vector<std::vector<double>> interleave(std::span<const Run> runs, const Effort& effort,
                                            Clock clock) {
  std::vector<int> calls(runs.size(), 1);
  std::vector<std::optional<double>> expected(runs.size());
  const auto call = [&](std::size_t i) {
    const double found = runs[i].call();
    if (!std::isfinite(found)) throw Refusal("a run that is measured has no finite result");
    if (expected[i].value_or(found) != found) {
      throw Refusal("a run that is measured does not repeat its result");
    }
    expected[i] = found;
  };
  for (std::size_t i = 0; effort.least_seconds > 0 && i < runs.size(); ++i) {
    if (runs[i].prepare) runs[i].prepare();
    call(i);  // cold caches, first allocations
    const double start = seconds(clock);
    call(i);
    const double once = std::max(seconds(clock) - start, 1e-7);
    calls[i] = std::max(1, static_cast<int>(std::ceil(effort.least_seconds / once)));
  }
  std::vector<std::vector<double>> result(runs.size());
  for (int repetition = 0; repetition < effort.repetitions; ++repetition) {
    for (std::size_t i = 0; i < runs.size(); ++i) {
      if (runs[i].prepare) runs[i].prepare();
      const double start = seconds(clock);
      for (int n = 0; n < calls[i]; ++n) call(i);
      result[i].push_back((seconds(clock) - start) / calls[i]);
    }
  }
  return result;
}

}  // namespace nuno::bench
