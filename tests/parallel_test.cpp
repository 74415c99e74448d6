#include <nuno/parallel.h>

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <thread>
#include <vector>

namespace nuno {
namespace {

TEST(Parallel, DoesEachOnce) {
  std::vector<int> times(1000);
  parallel_for(1000, [&](Index i) { ++times[static_cast<std::size_t>(i)]; });
  EXPECT_EQ(times, std::vector<int>(1000, 1));
  parallel_for(0, [&](Index) { ADD_FAILURE(); });
}

TEST(Parallel, GivesAnExceptionOnceTheOthersHaveStopped) {
  std::atomic<int> begun = 0, ended = 0;
  const auto work = [&](Index i) {
    ++begun;
    if (i == 3) throw std::runtime_error("three");
    ++ended;
  };
  EXPECT_THROW(parallel_for(1'000'000, work), std::runtime_error);
  EXPECT_EQ(begun, ended + 1);
  EXPECT_LT(begun, 1'000'000);
}

TEST(Parallel, StaysOnItsThreadWhereThatSharesTheCores) {
  const OnOneCore alone;
  const auto here = std::this_thread::get_id();
  parallel_for(100, [&](Index) { EXPECT_EQ(std::this_thread::get_id(), here); });
}

}  // namespace
}  // namespace nuno
