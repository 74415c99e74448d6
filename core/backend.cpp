#include <nuno/backend.h>

#include <nuno/rollout.h>

#include <algorithm>
#include <atomic>
#include <cassert>
#include <thread>

namespace nuno {

std::vector<double> Backend::errors(std::span<const double> gains, const Points& initial) const {
  std::vector<double> result(gains.size());
  std::atomic<std::size_t> next = 0;
  const auto work = [&] {
    for (std::size_t i; (i = next++) < gains.size();)
      result[i] = rollout(*this, gains[i], {}, initial).error.mean;
  };
  const std::size_t cores = std::max(1u, std::thread::hardware_concurrency());
  std::vector<std::jthread> threads;
  for (std::size_t t = 1; t < std::min(cores, gains.size()); ++t) threads.emplace_back(work);
  work();
  threads.clear();  // joins
  return result;
}

std::vector<ErrorSample> Backend::error_samples(std::span<const double>) const {
  assert(!"this engine has no slopes");
  return {};
}

}  // namespace nuno
