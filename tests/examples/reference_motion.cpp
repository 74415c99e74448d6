#include <nuno/reference_motion.h>

#include <gtest/gtest.h>

#include "arch.h"

namespace nuno {

TEST(Example, AReferenceIsAdvancedStepByStep) {
  ChainScene scene = arch();
  scene.reference = Reference::morph;
  const Problem problem = make_problem(scene);
  ReferenceMotion reference(problem, problem.arrival_time / 50);
  EXPECT_TRUE(reference.moves());
  for (int i = 0; i < 50; ++i) reference.advance();
  EXPECT_LT((reference.shape() - shape_of(problem.target)).norm(), 1e-10);
}

}  // namespace nuno
