#include <nuno/parallel.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

namespace nuno {
namespace {

thread_local bool on_one_core = false;

}  // namespace

OnOneCore::OnOneCore() : before_(std::exchange(on_one_core, true)) {}
OnOneCore::~OnOneCore() { on_one_core = before_; }

void parallel_for(Index count, const std::function<void(Index)>& work) {
  std::atomic<Index> next = 0;
  std::exception_ptr failure;
  std::mutex failing;
  const auto take = [&] {
    try {
      for (Index i; (i = next++) < count;) work(i);
    } catch (...) {
      const std::lock_guard lock(failing);
      if (!failure) failure = std::current_exception();
      next = count;
    }
  };
  {
    const auto cores =
        on_one_core ? 1 : static_cast<Index>(std::max(1u, std::thread::hardware_concurrency()));
    std::vector<std::jthread> threads;
    try {
      for (Index t = 1; t < std::min(cores, count); ++t) threads.emplace_back(take);
    } catch (const std::system_error&) {  // the machine has no more: fewer do as well
    }
    take();
  }
  if (failure) std::rethrow_exception(failure);
}

}  // namespace nuno
