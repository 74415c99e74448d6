#include <nuno/feasibility.h>

#include <gtest/gtest.h>

#include <nuno/native.h>
#include "arch.h"

namespace nuno {

TEST(Example, ATargetThatIsTooLongIsToldBeforeAnyFlight) {
  ChainScene scene = arch();
  scene.target_length = TargetLength::as_drawn;
  scene.target *= 2;
  const Feasibility asked = assess(*native::make_backend(make_problem(scene)));
  EXPECT_GT(asked.length_mismatch, 0.5);
  EXPECT_NE(verdict(asked), "");
}

}  // namespace nuno
