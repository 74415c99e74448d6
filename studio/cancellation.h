#pragma once

#include <nuno/optimize.h>

#include <atomic>
#include <map>
#include <memory>
#include <mutex>
#include <string>

namespace nuno::studio {

/// A newer request of the same page took this one's place.
struct Cancelled {};

/// One request's permission to work, which a newer request of the same page takes away.
class Turn {
 public:
  /// Throws Cancelled if the turn is over.
  void check() const {
    if (state_ && state_->over) throw Cancelled();
  }
  /// How much of the work is done, 0 … 1, for who asks meanwhile.
  void report(double share) const {
    if (state_) state_->progress = share;
  }
  double progress() const { return state_ ? state_->progress.load() : 0; }

 private:
  friend class Turns;
  struct State {
    std::atomic<bool> over = false;
    std::atomic<double> progress = 0;
  };
  std::shared_ptr<State> state_;
};

/// Who works for which page. Shared by all threads.
class Turns {
 public:
  /// Ends the turn that `page` has and begins a new one; an empty `page` never ends another's.
  Turn begin(const std::string& page);
  void end(const std::string& page, const Turn& turn);
  /// The turn that `page` has; without one, a turn that nobody ends.
  Turn running(const std::string& page);

 private:
  std::mutex mutex_;
  std::map<std::string, std::shared_ptr<Turn::State>> running_;
};

/// What one rollout takes, in particle-steps.
double work_of(const Backend& backend);

/// The objective of `backend`, in portions of a fraction of a second; between them it throws
/// Cancelled if the turn is over. The errors are the same to the bit.
Objective cancellable(const Backend& backend, const Turn& turn);

}  // namespace nuno::studio
