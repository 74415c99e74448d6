#include <nuno/robust.h>

#include <gtest/gtest.h>

#include <nuno/native.h>
#include "arch.h"

namespace nuno {

TEST(Example, ARobustErrorIsAMeanOverPerturbedStarts) {
  const auto backend = native::make_backend(make_problem(arch()));
  const double gain = 0.01;
  const double alone = objective(*backend).errors({&gain, 1}).front();
  const double robust = robust_objective(*backend).errors({&gain, 1}).front();
  EXPECT_NE(robust, alone);
  EXPECT_NEAR(robust, alone, 0.01 * backend->cloth().size);  // ten times the perturbation
}

}  // namespace nuno
