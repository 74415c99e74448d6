// A result file says what the flight was, each number in its own field.

#include <nuno/result_file.h>

#include <gtest/gtest.h>

#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>

#include "scripted_engine.h"

namespace nuno {
namespace {

using Json = nlohmann::json;

/// What `write` writes.
template <typename Write>
Json written(Write&& write) {
  std::FILE* const file = std::tmpfile();
  write(file);
  std::string text(static_cast<std::size_t>(std::ftell(file)), '\0');
  std::rewind(file);
  EXPECT_EQ(std::fread(text.data(), 1, text.size(), file), text.size());
  std::fclose(file);
  return Json::parse(text);
}

Json result_of(const Backend& backend, const Rollout& flight,
               const std::optional<Optimization>& optimization = std::nullopt) {
  ChainScene scene;
  scene.name = "name";
  return written(
      [&](std::FILE* file) { write_result(file, scene, backend, flight, 1.5, optimization); });
}

TEST(ResultFile, HasTheErrorsOverTheSizeOfTheCloth) {
  const ScriptedBackend engine = engine_of_error([](double gain) { return 1 + gain; });
  const Rollout flight = rollout(engine, 2, {.frames_per_second = 2});
  const Json result = result_of(engine, flight);
  const double length = engine.cloth().size;
  EXPECT_GT(length, 4);
  EXPECT_EQ(result["cloth_length"], length);
  EXPECT_EQ(result["error"]["mean"], flight.error.mean);
  EXPECT_EQ(result["error"]["relative"], flight.error.mean / length);
  EXPECT_EQ(result["error"]["max"], flight.error.max);
  EXPECT_EQ(result["error"]["centroid"], flight.error.centroid);
  EXPECT_EQ(result["control_effort"], flight.control_effort);
  EXPECT_EQ(result["max_strain"], flight.max_strain);
  EXPECT_EQ(result["sensitivity"], 1.5);
  EXPECT_EQ(result["alpha"], 2);
  EXPECT_FALSE(result.contains("alphas"));
  EXPECT_EQ(result["scene"], "name");
  EXPECT_EQ(result["backend"], "scripted");
  EXPECT_EQ(result["steps"], 5);
  EXPECT_EQ(result["time_step"], 0.2);
  EXPECT_EQ(result["frames"]["times"], Json({0.0, 0.5, 1.0}));
  EXPECT_EQ(result["frames"]["positions"][2], result["final"]);
  EXPECT_EQ(result["final"][1], Json({flight.final(0, 1), flight.final(1, 1)}));
  EXPECT_FALSE(result.contains("kind"));
  EXPECT_FALSE(result.contains("optimization"));
}

TEST(ResultFile, OfASheetHasItsSizeAndItsFaces) {
  Problem problem;
  problem.form = make_sheet(Points{{0, 0, 2, 2}, {0, 0, 0, 0}, {0, 2, 2, 0}}, {{0, 1, 2, 3}}, {},
                            Rest::initial, 0);
  problem.target = problem.cloth().initial;
  problem.target.row(2).array() += 0.5;
  problem.arrival_time = 1;
  const ScriptedBackend engine(problem, 1, [](const Moment& now) { return now.positions; });
  const Json result = result_of(engine, rollout(engine, 0));
  EXPECT_EQ(result["kind"], "sheet");
  EXPECT_EQ(result["size"], 2);
  EXPECT_FALSE(result.contains("cloth_length"));
  EXPECT_EQ(result["faces"], Json({{0, 1, 2, 3}}));
  EXPECT_EQ(result["error"]["relative"], 0.25);
  EXPECT_EQ(result["target"][1], Json({0.0, 0.0, 2.5}));
}

TEST(ResultFile, SaysWhetherTheSearchAndTheRefinementGotThere) {
  const ScriptedBackend engine = engine_of_error([](double gain) { return 1 + gain; });
  const Rollout flight = rollout(engine, 2);
  for (const bool there : {true, false}) {
    Optimization found{"global", {}};
    found.summary.status = there ? OptimizeStatus::converged : OptimizeStatus::budget;
    found.summary.evaluations = 7;
    found.summary.history = {{1, 2}, {3, HUGE_VAL}};
    found.pareto_front = {{.gain = 1, .error = 2, .effort = 3}};
    found.refinement.emplace();
    found.refinement->converged = there;
    found.refinement->error_before = 0.5;
    found.refinement->rollouts = 5;
    found.refinement->jacobians = 3;
    const Json told = result_of(engine, flight, found)["optimization"];
    EXPECT_EQ(told["status"], there ? "converged" : "budget");
    EXPECT_EQ(told["evaluations"], 7);
    EXPECT_EQ(told["history"], Json({{{"alpha", 1.0}, {"error", 2.0}}}));  // 3 diverged
    EXPECT_EQ(told["pareto_front"],
              Json({{{"alpha", 1.0}, {"error", 2.0}, {"control_effort", 3.0}}}));
    EXPECT_EQ(told["refinement"]["status"], there ? "converged" : "nearest");
    EXPECT_EQ(told["refinement"]["error_before"], 0.5);
    EXPECT_EQ(told["refinement"]["rollouts"], 5);
    EXPECT_EQ(told["refinement"]["jacobians"], 3);
  }
}

}  // namespace
}  // namespace nuno
