#pragma once

#include <nuno/problem.h>

#include <atomic>
#include <map>
#include <memory>
#include <mutex>
#include <stop_token>
#include <string>

namespace nuno::studio {

/// One request's permission to work, which a newer request of the same page takes away, and a
/// client that leaves.
class Turn {
 public:
  /// Throws Stopped if the turn is over.
  void check() const {
    if (is_over()) throw Stopped();
  }
  bool is_over() const { return state_ && state_->stop.stop_requested(); }
  void end() const {
    if (state_) state_->stop.request_stop();
  }
  /// For the problem that is worked on.
  std::stop_token token() const { return state_ ? state_->stop.get_token() : std::stop_token(); }
  /// How much of the work is done, 0 … 1, for who asks meanwhile.
  void report(double share) const {
    if (state_) state_->progress = share;
  }
  double progress() const { return state_ ? state_->progress.load() : 0; }

 private:
  friend class Turns;
  struct State {
    std::stop_source stop;
    std::atomic<double> progress = 0;
  };
  std::shared_ptr<State> state_;
};

/// Who works for which page. Shared by all threads.
class Turns {
 public:
  /// Ends the turn that `page` has and begins a new one; an empty `page` never ends another's.
  Turn begin(const std::string& page);
  void forget(const std::string& page, const Turn& turn);
  /// The turn that `page` has; without one, a turn that nobody ends.
  Turn running(const std::string& page);

 private:
  std::mutex mutex_;
  std::map<std::string, std::shared_ptr<Turn::State>> running_;
};

}  // namespace nuno::studio
