// The engines of sheets against an independent program's converged E(α).

#include <nuno/bullet.h>
#include <nuno/rollout.h>

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "sheets.h"

namespace nuno {
namespace {

SheetScene scene_of(const std::string& name) {
  const Mesh start = read_plain_obj(NUNO_TEST_DATA "/sheets/" + name + "-start.obj");
  SheetScene scene;
  scene.name = name;
  scene.arrival_time = 1;
  scene.initial = start.vertices;
  scene.faces = start.faces;
  scene.target = read_plain_obj(NUNO_TEST_DATA "/sheets/" + name + "-target.obj").vertices;
  return scene;
}

class SheetReference : public testing::TestWithParam<const char*> {};

TEST_P(SheetReference, BulletGivesTheSameErrorAtEveryGainHeld) {
  const nlohmann::json all =
      nlohmann::json::parse(std::ifstream(NUNO_TEST_DATA "/reference-sheets.json"));
  const auto backend = bullet::make_backend(make_problem(scene_of(GetParam())));
  for (const auto& sample : all.at("scenes").at(GetParam()).at("hold")) {
    // Where half the step moved the reference itself the flight is fragile: no figure to hold to.
    if (sample.at("half_step_moves") > 1e-4) continue;
    const double gain = sample.at("alpha");
    // The figures are converged to 2e-5; this engine's own step and rounding stay below as much.
    EXPECT_NEAR(rollout(*backend, gain).error.mean / backend->cloth().size,
                sample.at("error").get<double>(), 5e-5)
        << "gain " << gain;
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, SheetReference,
                         testing::Values("square-to-halfpipe", "disc-to-oblique"));

}  // namespace
}  // namespace nuno
