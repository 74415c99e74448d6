// What engines say of themselves.

#include <nuno/optimize.h>
#include <nuno/robust.h>
#include <nuno/rollout.h>

#include <gtest/gtest.h>

#include <cmath>

#include "engines.h"
#include "scene_library.h"
#include "sheet_library.h"

namespace nuno {
namespace {

class EngineLimits : public testing::TestWithParam<Engine> {
 protected:
  std::unique_ptr<Backend> make(std::optional<double> time_step = {}) const {
    if (GetParam().make != make_bullet) {
      return GetParam().make(make_problem(scene_library::straight_to_s()), time_step);
    }
    const scene_library::FlatMesh mesh = scene_library::grid(1, 1, 4, 4);
    SheetScene scene;
    scene.arrival_time = 1;
    scene.initial = scene.target = mesh.vertices;
    scene.faces = mesh.faces;
    return GetParam().make(make_problem(scene), time_step);
  }
};

// The control's own oscillation turns by 0.2 rad in a step of the largest gain.
TEST_P(EngineLimits, HasTheLargestGainThatItsStepResolves) {
  for (const double step : {1e-3, 2e-4}) {
    const auto backend = make(step);
    const double phase = std::sqrt(backend->largest_gain() / backend->cloth().particle_mass);
    EXPECT_NEAR(phase * backend->time_step(), 0.2, 1e-12);
  }
}

// Small enough to grow a thousandfold before it is as large as the cloth, and far above rounding.
TEST_P(EngineLimits, PerturbsByMoreThanItsRounding) {
  const double size = make()->smallest_perturbation();
  EXPECT_GE(size, GetParam().rounding / 10);
  EXPECT_LE(size, 1e-3);
}

INSTANTIATE_TEST_SUITE_P(All, EngineLimits,
                         testing::Values(native_engine, box2d_weld_engine, box2d_pair_engine,
                                         bullet_engine),
                         [](const auto& engine) { return std::string(engine.param.name); });

// The kernels of the batch have a damping of their own.
TEST(NativeDamping, HasTheSameBitsInTheBatchAndStepByStepAtAnyRatio) {
  for (const Reference reference : {Reference::hold, Reference::morph}) {
    for (const double ratio : {0.0, 0.1, 0.35, 1.5}) {
      ChainScene scene = scene_library::straight_to_s();
      scene.reference = reference;
      scene.damping_ratio = ratio;
      const auto backend = native::make_backend(make_problem(scene));
      const std::vector<double> gains = {0.03, 0.2};
      const std::vector<double> errors = backend->errors(gains);
      for (std::size_t i = 0; i < 2; ++i) {
        EXPECT_EQ(errors[i], rollout(*backend, gains[i]).error.mean) << ratio;
      }
    }
  }
}

}  // namespace
}  // namespace nuno
