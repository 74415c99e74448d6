#include <nuno/bullet.h>

#include <gtest/gtest.h>

#include <nuno/rollout.h>
#include "../sheets.h"
#include "arch.h"

namespace nuno {

TEST(Example, BulletFliesASheet) {
  const Problem problem = make_problem(throw_scene());
  EXPECT_LT(rollout(*bullet::make_backend(problem), 0).error.centroid, 1e-4 * problem.cloth().size);
  EXPECT_THROW(bullet::make_backend(make_problem(arch())), InputError);
}

}  // namespace nuno
