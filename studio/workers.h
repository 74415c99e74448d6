#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

#include "studio/api.h"

namespace nuno::studio {

/// The threads that compute, which are not the one that answers.
class Workers {
 public:
  /// `most` threads, or as many as the machine has. Throws OutputError where that is none.
  explicit Workers(std::size_t most);
  ~Workers();
  Workers(const Workers&) = delete;
  Workers& operator=(const Workers&) = delete;

  /// Has `work` done, and `done` called by the thread that did it; false where too much waits
  /// already.
  bool add(Work work, std::function<void(Answer)> done);

 private:
  struct Task {
    Work work;
    std::function<void(Answer)> done;
  };
  void run();

  std::mutex mutex_;
  std::condition_variable changed_;
  bool ending_ = false;
  std::deque<Task> waiting_;
  std::vector<std::jthread> threads_;
};

}  // namespace nuno::studio
