#include <nuno/native.h>

#include <gtest/gtest.h>

#include "arch.h"

namespace nuno {

TEST(Example, TheNativeEngineKnowsItsDerivatives) {
  const auto backend = native::make_backend(make_problem(arch()));
  EXPECT_EQ(backend->name(), "native");
  EXPECT_TRUE(backend->has_derivatives());
}

}  // namespace nuno
