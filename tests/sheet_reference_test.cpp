// The engines of sheets against an independent program's converged E(α) and end shape.

#include <nuno/rollout.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <nlohmann/json.hpp>
#include <vector>

#include "engines.h"
#include "sheets.h"

namespace nuno {
namespace {

struct Sample {
  const char* scene;
  const Engine* engine;
};

class SheetReference : public testing::TestWithParam<Sample> {
 protected:
  static nlohmann::json figures() {
    std::ifstream file(NUNO_TEST_DATA "/reference-sheets.json");
    return nlohmann::json::parse(file).at("scenes").at(GetParam().scene);
  }
  static std::unique_ptr<Backend> backend() {
    return GetParam().engine->make(make_problem(reference_sheet(GetParam().scene)), std::nullopt);
  }
};

TEST_P(SheetReference, HasTheSameErrorAtEveryGainHeld) {
  const auto engine = backend();
  const nlohmann::json samples = figures().at("hold");
  ASSERT_EQ(samples.size(), 5u);
  for (const auto& sample : samples) {
    // Where half the step moved the reference itself the flight is fragile: no figure to hold to.
    if (sample.at("half_step_moves").get<double>() > 1e-4) continue;
    const double gain = sample.at("alpha");
    // The figures are converged to 1e-5, and so is either engine at its default step.
    EXPECT_NEAR(rollout(*engine, gain).error.mean / engine->cloth().size,
                sample.at("error").get<double>(), 2e-5)
        << "gain " << gain;
  }
}

TEST_P(SheetReference, EndsInTheSameShapeWithoutControl) {
  const auto engine = backend();
  const auto points = figures().at("launch_only_final").get<std::vector<std::array<double, 3>>>();
  Points expected(3, static_cast<Index>(points.size()));
  for (Index i = 0; i < expected.cols(); ++i) {
    expected.col(i) = Eigen::Vector3d::Map(points[static_cast<std::size_t>(i)].data());
  }
  const Points off = rollout(*engine, 0).final - expected;
  // The worst particle, a free corner that flutters: three times what the disc has on average.
  EXPECT_LT(off.colwise().norm().maxCoeff(), 3e-4 * engine->cloth().size);
}

INSTANTIATE_TEST_SUITE_P(Scenes, SheetReference,
                         testing::Values(Sample{"square-to-halfpipe", &native_engine},
                                         Sample{"square-to-halfpipe", &bullet_engine},
                                         Sample{"disc-to-oblique", &native_engine},
                                         Sample{"disc-to-oblique", &bullet_engine}),
                         [](const auto& of) {
                           std::string name =
                               std::string(of.param.scene) + "_" + of.param.engine->name;
                           std::ranges::replace(name, '-', '_');
                           return name;
                         });

}  // namespace
}  // namespace nuno
