#pragma once

#include <atomic>
#include <chrono>

namespace nuno {

/// When work tells a person off a terminal how far it is: not in its first ten seconds, then at
/// most every half minute. One for all threads: to a person they do one work.
class ProgressPace {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// Whether a line is due `now`; of work that has not begun, this begins it.
  bool is_due(Time now);

  /// The work has ended: what is asked next begins another.
  void end() { next_line_ = no_work; }

 private:
  static constexpr Time no_work{};
  std::atomic<Time> next_line_ = no_work;
};

}  // namespace nuno
