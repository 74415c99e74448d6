// Both engines against an independent program's converged E(α) and end shapes.

#include "engines.h"

#include <nuno/optimize.h>
#include <nuno/rollout.h>
#include <nuno/scene_file.h>

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

namespace nuno {
namespace {

struct Reference {
  std::vector<double> gains;
  std::vector<double> errors;  ///< [m]
  nlohmann::json shapes;
};

Reference reference(const std::string& name) {
  const nlohmann::json all = nlohmann::json::parse(std::ifstream(NUNO_TEST_DATA "/reference.json"));
  const nlohmann::json& scene = all.at("scenes").at(name);
  return {scene.at("alpha"), scene.at("error"), scene.at("final_at_alpha")};
}

Problem problem_of(const std::string& name) {
  return make_problem(std::get<ChainScene>(read_scene(NUNO_SCENES "/" + name + ".json")));
}

class NativeReference : public testing::TestWithParam<const char*> {};

TEST_P(NativeReference, GivesTheSameErrorAtEveryGain) {
  const Reference expected = reference(GetParam());
  const Problem problem = problem_of(GetParam());
  const auto backend = native::make_backend(problem);
  const std::vector<double> errors = backend->errors(expected.gains);
  for (std::size_t i = 0; i < errors.size(); ++i) {
    // The bar of the project; the engine's own step error is below 4e-4 here.
    EXPECT_NEAR(errors[i], expected.errors[i], 1e-3 * problem.chain().size)
        << "gain " << expected.gains[i];
  }
}

TEST_P(NativeReference, EndsInTheSameShapes) {
  const Reference expected = reference(GetParam());
  const Problem problem = problem_of(GetParam());
  const auto backend = native::make_backend(problem);
  for (const auto& item : expected.shapes.items()) {
    Points shape(2, problem.chain().particles());
    for (Index i = 0; i < shape.cols(); ++i) {
      const auto& point = item.value().at(static_cast<std::size_t>(i));
      shape.col(i) = Eigen::Vector2d(point.at(0), point.at(1));
    }
    const Points final = rollout(*backend, std::stod(item.key())).final;
    // Particle by particle, place included. A ballistic launch stretches the segments and leaves
    // them ringing for all of the flight; the default step resolves the slow part of that.
    const double resolved = problem.launch == Launch::inextensible ? 2e-4 : 5e-3;
    EXPECT_LT(arrival_error(final, shape).mean, resolved * problem.chain().size) << item.key();
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, NativeReference,
                         testing::Values("s-curve-32", "s-curve-32-inextensible", "s-curve-64",
                                         "hanging-to-arch-32"));

TEST(Box2dReference, GivesTheSameErrorAtGainsUpToThreeTimesTheBest) {
  const Reference expected = reference("s-curve-32-inextensible");
  const Problem problem = problem_of("s-curve-32-inextensible");
  const auto backend = box2d::make_backend(problem);
  for (std::size_t i = 0; i < expected.gains.size() && expected.gains[i] <= 0.06; ++i) {
    EXPECT_NEAR(rollout(*backend, expected.gains[i]).error.mean, expected.errors[i],
                2e-3 * problem.chain().size)
        << "gain " << expected.gains[i];
  }
}

struct FirstValley {
  const char* scene;
  double gain;   ///< [N/m]
  double error;  ///< relative to the cloth's length
};

class SteepestDescentReference : public testing::TestWithParam<FirstValley> {};

TEST_P(SteepestDescentReference, EndsInTheFirstValley) {
  const auto [scene, gain, error] = GetParam();
  const Problem problem = problem_of(scene);
  const auto backend = native::make_backend(problem);
  const OptimizeSummary summary = steepest_descent(objective(*backend));
  EXPECT_NEAR(summary.gain, gain, 0.03 * gain);
  EXPECT_NEAR(summary.error / problem.chain().size, error, 1e-3);
}

INSTANTIATE_TEST_SUITE_P(Scenes, SteepestDescentReference,
                         testing::Values(FirstValley{"s-curve-32", 0.0181, 0.02165},
                                         FirstValley{"s-curve-64", 0.0094, 0.02029},
                                         FirstValley{"hanging-to-arch-32", 0.0151, 0.08397}));

}  // namespace
}  // namespace nuno
