#include <nuno/box2d.h>

#include <gtest/gtest.h>

#include <nuno/rollout.h>
#include "arch.h"

namespace nuno {

TEST(Example, Box2dFliesAChainOnEitherKindOfHinge) {
  const Problem problem = make_problem(arch());
  const auto weld = box2d::make_backend(problem);
  const auto pair = box2d::make_backend_with({.hinge = box2d::Hinge::spring_pair}, problem);
  EXPECT_LT(rollout(*weld, 0).error.centroid, 1e-4 * problem.cloth().size);
  EXPECT_LT(rollout(*pair, 0).error.centroid, 1e-4 * problem.cloth().size);
}

}  // namespace nuno
