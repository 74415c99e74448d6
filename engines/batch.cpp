#include <nuno/batch.h>

#include <nuno/output.h>
#include <nuno/parallel.h>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

namespace nuno {
namespace {

using Finish = std::function<void()>;

/// What is worked out and waits for the calling thread.
class Finished {
 public:
  explicit Finished(std::size_t most) : most_(most) {}

  void put(Finish finish, const std::stop_token& stop) {
    std::unique_lock lock(mutex_);
    if (!changed_.wait(lock, stop, [&] { return waiting_.size() < most_; })) return;
    waiting_.push_back(std::move(finish));
    changed_.notify_all();
  }

  Finish take() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return !waiting_.empty(); });
    Finish finish = std::move(waiting_.front());
    waiting_.pop_front();
    changed_.notify_all();
    return finish;
  }

 private:
  std::size_t most_;
  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::deque<Finish> waiting_;
};

}  // namespace

void run_batch(Index count, Index jobs, const std::function<Finish(Index, std::stop_token)>& work) {
  std::atomic<Index> next = 0;
  Finished finished(static_cast<std::size_t>(jobs));
  const auto serve = [&](const std::stop_token& stop) {
    const OnOneCore alone;
    for (Index i = 0; !stop.stop_requested() && (i = next++) < count;) {
      try {
        finished.put(work(i, stop), stop);
      } catch (...) {
        finished.put([error = std::current_exception()] { std::rethrow_exception(error); }, stop);
      }
    }
  };
  std::vector<std::jthread> threads;  // stopped and joined however this ends
  try {
    const SignalsHeld by_the_threads;  // the calling thread writes, and is ended by them
    for (Index t = 0; t < std::min(jobs, count); ++t) threads.emplace_back(serve);
  } catch (const std::system_error&) {  // the machine has no more: fewer do as well
  }
  if (threads.empty()) {
    const OnOneCore alone;
    for (Index i = 0; i < count; ++i) work(i, {})();
    return;
  }
  for (Index left = count; left > 0; --left) finished.take()();
}

}  // namespace nuno
