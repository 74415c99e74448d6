#include <nuno/refine.h>

#include <gtest/gtest.h>

#include <nuno/native.h>
#include "arch.h"

namespace nuno {

TEST(Example, RefinementPutsTheClothOnTheTarget) {
  ChainScene scene = arch();
  scene.particles = 8;
  scene.reference = Reference::morph;
  scene.damping_ratio = 0.7;
  const Problem problem = make_problem(scene);
  const double gain = tracking_gain(*native::make_backend(problem));
  const RefineSummary refined =
      refine(problem, gain, native::make_backend, native::make_backend, {.tolerance = 1e-3});
  EXPECT_LE(refined.flight.error.mean, refined.error_before) << refined.reason;
  EXPECT_LE(refined.flight.error.mean, 1e-3 * problem.cloth().size) << refined.reason;
}

}  // namespace nuno
