#pragma once

#include <nuno/optimize.h>

#include <atomic>
#include <cstddef>
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
    if (over_ && *over_) throw Cancelled();
  }

 private:
  friend class Turns;
  std::shared_ptr<std::atomic<bool>> over_;
};

/// Who works for which page. Shared by all threads.
class Turns {
 public:
  /// Ends the turn that `page` has and begins a new one; an empty `page` never ends another's.
  Turn begin(const std::string& page);
  void end(const std::string& page, const Turn& turn);

 private:
  std::mutex mutex_;
  std::map<std::string, std::shared_ptr<std::atomic<bool>>> running_;
};

/// The objective of `backend`, in portions of a fraction of a second; between them it throws
/// Cancelled if the turn is over. The errors are the same to the bit.
Objective cancellable(const Backend& backend, const Turn& turn);

}  // namespace nuno::studio
