#include <nuno/progress.h>

#include <gtest/gtest.h>

#include <nuno/native.h>
#include "arch.h"

namespace nuno {

TEST(Example, ProgressCountsAndChangesNothing) {
  const auto backend = native::make_backend(make_problem(arch()));
  const LongWork told(*backend, "arch", flights_of_search(*backend));
  const double gain = 0.01;
  const Objective plain = objective(*backend);
  EXPECT_EQ(with_progress(plain, "arch").errors({&gain, 1}), plain.errors({&gain, 1}));
}

}  // namespace nuno
