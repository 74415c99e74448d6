#include <nuno/batch.h>

#include <gtest/gtest.h>

namespace nuno {

TEST(Example, ABatchWorksOnManyThreadsAndCollectsOnOne) {
  Index sum = 0;
  run_batch(10, 2, [&](Index i, std::stop_token) {
    const Index square = i * i;  // on any thread
    return [&sum, square] { sum += square; };
  });
  EXPECT_EQ(sum, 285);
}

}  // namespace nuno
