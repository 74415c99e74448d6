#include <nuno/parallel.h>

#include <gtest/gtest.h>

#include <vector>

namespace nuno {

TEST(Example, WorkIsSpreadOverAllCores) {
  std::vector<Index> squares(100);
  parallel_for(100, [&](Index i) { squares[static_cast<std::size_t>(i)] = i * i; });
  EXPECT_EQ(squares[99], 99 * 99);
}

}  // namespace nuno
