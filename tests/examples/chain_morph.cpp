#include <nuno/chain_morph.h>

#include <gtest/gtest.h>

#include "arch.h"

namespace nuno {

TEST(Example, AMorphGoesFromTheOneShapeToTheOther) {
  const Problem problem = make_problem(arch());
  ChainMorph morph(problem, 0.01);
  for (int i = 0; i < 100; ++i) morph.advance();
  EXPECT_LT((morph.shape() - shape_of(problem.target)).norm(), 1e-10);
}

}  // namespace nuno
