#include <nuno/conditioning.h>

#include <gtest/gtest.h>

#include <nuno/native.h>
#include "arch.h"

namespace nuno {

TEST(Example, ACalmFlightIsNotCalledFragile) {
  const auto backend = native::make_backend(make_problem(arch()));
  const Rollout flight = rollout(*backend, 0);
  ASSERT_FALSE(diverged(flight));
  const double growth = bounded_sensitivity(*backend, flight);
  EXPECT_LT(growth, largest_calm_sensitivity);
  EXPECT_EQ(fragility(growth), "");
}

}  // namespace nuno
