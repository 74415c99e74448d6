#include "progress_pace.h"

namespace nuno {

bool ProgressPace::is_due(Time now) {
  constexpr auto patience = std::chrono::seconds(10), pause = std::chrono::seconds(30);
  Time due = next_line_;
  if (due == no_work) {
    next_line_ = now + patience;
    return false;
  }
  return now >= due && next_line_.compare_exchange_strong(due, now + pause);
}

}  // namespace nuno
