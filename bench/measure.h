#pragma once

#include <functional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace nuno::bench {

/// A result is wrong, so its speed means nothing; the message says which and by how much.
class Refusal : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// What repetitions of one measurement gave.
struct Statistics {
  double median = 0;
  double min = 0;
  double max = 0;
};

Statistics statistics(std::vector<double> values);
Statistics exactly(double value);
Statistics scaled(const Statistics& statistics, double factor);

/// Of the quotients a[i]/b[i], each of two runs that stood side by side.
Statistics ratio(std::span<const double> a, std::span<const double> b);

enum class Clock {
  wall,
  cpu  ///< time on a core, of all threads together: what other programs take does not count
};
double seconds(Clock clock);

/// Something to be measured. `call` returns a number made from its result; a run that gives another
/// number than before is refused.
struct Run {
  std::function<double()> call;
  std::function<void()> prepare = {};  ///< not measured; before every measurement
};

struct Effort {
  int repetitions = 9;
  double least_seconds = 0.01;  ///< of a measurement: short calls are repeated until then;
                                ///< 0: calls are long, so one a measurement and none to warm up
};

/// Seconds per call, [run][repetition]: A B C A B C …, so that whatever else the machine does meets
/// all of them alike.
std::vector<std::vector<double>> interleave(std::span<const Run> runs, const Effort& effort,
                                            Clock clock);

}  // namespace nuno::bench
