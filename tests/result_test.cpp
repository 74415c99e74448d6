// What a result file says, and that it is true.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "program.h"

namespace nuno {
namespace {

/// Whether a JSON holds a null anywhere.
bool has_null(const Json& json) {
  return json.is_null() ||
         (json.is_structured() && std::any_of(json.begin(), json.end(), has_null));
}

class Result : public Program {};

TEST_F(Result, OfSeveralCoefficientsCanBeFlownAgain) {
  const std::string cloth = scene("s-curve-32");
  for (const std::string backend : {"native", "box2d"}) {
    const Json best = simulated({"optimize", cloth, "--backend", backend, "--coefficients", "2"});
    const Json alphas = best["alphas"];
    ASSERT_EQ(alphas.size(), 2u) << backend;
    EXPECT_EQ(best["alpha"], alphas.back());
    const Json stages = best["optimization"]["coefficients"]["stages"];
    ASSERT_EQ(stages.size(), 2u);
    EXPECT_EQ(stages[1]["alphas"], alphas);
    EXPECT_EQ(stages[1]["error"], best["error"]["mean"]);
    // By a third and more on this scene, docs/coefficients.md.
    EXPECT_LT(stages[1]["error"], 0.7 * stages[0]["error"].get<double>());
    EXPECT_FALSE(has_null(best));

    std::string list = alphas.dump();  // [A,B]
    list = list.substr(1, list.size() - 2);
    const Json again = simulated({"simulate", cloth, "--backend", backend, "--alpha", list});
    EXPECT_EQ(again["final"], best["final"]);
    EXPECT_EQ(again["alphas"], alphas);
  }
}

TEST_F(Result, OfALimitCountsEveryRollout) {
  const Json result = simulated({"optimize", scene("s-curve-32"), "--effort-limit", "0.1"});
  const Json best = simulated({"optimize", scene("s-curve-32")})["optimization"];
  // A search and what it found, launch only, 64 gains, and 30 halvings about the limit.
  const int others = 1 + 64 + 30;
  EXPECT_GT(result["optimization"]["evaluations"], best["evaluations"].get<int>() + others);
  EXPECT_LT(result["optimization"]["evaluations"], 2 * best["evaluations"].get<int>() + others);
}

TEST_F(Result, OfTheSearchsErrorAsALimitKeepsIt) {
  const Json best = simulated({"optimize", scene("s-curve-32")});
  const double error = best["error"]["relative"];
  const std::string limit = std::to_string(1.001 * error);  // 0.9 %, far below other gains
  const Json kept = simulated({"optimize", scene("s-curve-32"), "--error-limit", limit});
  EXPECT_LE(kept["error"]["relative"], 1.0011 * error);
}

TEST_F(Result, OfRefinementWithinALimitIsNoWorseThanOfTheGainAlone) {
  Json morph = read_json(scene("s-curve-32"));
  morph["reference"] = "morph";
  morph["damping_ratio"] = 0.7;
  write_text(in_folder("morph.json"), morph.dump());
  const auto effort = [](const Json& result) { return result["control_effort"].get<double>(); };
  const auto error = [](const Json& result) { return result["error"]["relative"].get<double>(); };
  for (const std::string& cloth : {scene("s-curve-32"), in_folder("morph.json").string()}) {
    for (const std::string limit : {"0.01", "0.5"}) {
      std::vector<std::string> command = {"optimize", cloth, "--effort-limit", limit};
      const Json alone = simulated(command);
      command.push_back("--refine");
      const Json refined = simulated(command);
      EXPECT_LE(effort(refined), std::stod(limit)) << cloth;
      EXPECT_LE(error(refined), error(alone)) << cloth << ' ' << limit;
    }
    for (const std::string limit : {"0.2", "0.05"}) {
      std::vector<std::string> command = {"optimize", cloth, "--error-limit", limit};
      const Json alone = simulated(command);
      command.push_back("--refine");
      const Json refined = simulated(command);
      EXPECT_LE(error(refined), std::stod(limit)) << cloth;
      EXPECT_LE(effort(refined), effort(alone)) << cloth << ' ' << limit;
    }
  }
}

TEST_F(Result, HasEveryFieldAndNoNull) {
  const Json result =
      simulated({"simulate", scene("s-curve-32-inextensible"), "--alpha", "0.0181"});
  const std::set<std::string> expected = {
      "nuno_result",    "scene",       "backend",         "status",           "alpha",
      "time_step",      "steps",       "cloth_length",    "target_scale",     "error",
      "control_effort", "final",       "launch_velocity", "target",           "frames",
      "max_strain",     "sensitivity", "final_velocity",  "truncation_error", "input"};
  std::set<std::string> fields;
  for (const auto& item : result.items()) fields.insert(item.key());
  EXPECT_EQ(fields, expected);
  EXPECT_EQ(result["scene"], "s-curve-32-inextensible");
  EXPECT_EQ(result["backend"], "native");
  EXPECT_EQ(result["status"], "ok");
  EXPECT_FALSE(has_null(result));
  for (const char* shape : {"launch_velocity", "target", "final", "final_velocity"}) {
    EXPECT_EQ(result[shape].size(), 32u) << shape;
  }
}

TEST_F(Result, ReadsTheGainBackToTheLastBit) {
  // 17 digits, which a detour through another format would round.
  const Json result =
      simulated({"simulate", scene("s-curve-32"), "--alpha", "0.018123456789012347"});
  EXPECT_EQ(result["alpha"].get<double>(), 0.018123456789012347);
}

TEST_F(Result, OfMinusZeroIsOfZero) {
  const Json result = simulated({"simulate", scene("s-curve-32"), "--alpha", "-0"});
  EXPECT_EQ(result["alpha"].dump(), "0.0");
}

TEST_F(Result, ErrorIsTheDistanceOfFinalAndTargetToTheLastDigits) {
  const Json result = simulated({"simulate", scene("s-curve-32"), "--alpha", "0.0181"});
  double sum = 0, largest = 0;
  for (std::size_t i = 0; i < 32; ++i) {
    const Json &a = result["final"][i], &b = result["target"][i];
    const double distance = std::hypot(a[0].get<double>() - b[0].get<double>(),
                                       a[1].get<double>() - b[1].get<double>());
    sum += distance;
    largest = std::max(largest, distance);
  }
  const Json& error = result["error"];
  // 32 additions round by at most 32 units in the last place.
  EXPECT_NEAR(error["mean"].get<double>(), sum / 32, 1e-14);
  EXPECT_NEAR(error["max"].get<double>(), largest, 1e-14);
  EXPECT_EQ(error["relative"].get<double>(),
            error["mean"].get<double>() / result["cloth_length"].get<double>());
}

TEST_F(Result, StepsEndAtTheArrivalTime) {
  for (const char* step : {"0.001", "0.0003", "0.007"}) {
    const Json result = simulated({"simulate", scene("s-curve-32"), "--time-step", step});
    // One rounding of the quotient, one of the product.
    EXPECT_NEAR(result["time_step"].get<double>() * result["steps"].get<double>(), 1, 1e-15);
  }
}

TEST_F(Result, FramesBeginAtTheInitialShapeAndEndAtTheFinalOne) {
  const Json result = simulated({"simulate", scene("hanging-to-arch-32"), "--alpha", "0.0151"});
  const Json &times = result["frames"]["times"], &positions = result["frames"]["positions"];
  ASSERT_EQ(times.size(), positions.size());
  EXPECT_EQ(times.size(), 49u) << "0.8 s at 60 frames per second, and the first";
  EXPECT_EQ(times.front(), 0.0);
  EXPECT_EQ(times.back(), 0.8);
  EXPECT_EQ(positions.front().front(), Json({0.0, 2.0}));
  EXPECT_EQ(positions.back(), result["final"]);
}

TEST_F(Result, IsNamedAfterTheFileIfTheSceneHasNoName) {
  write_text(in_folder("nameless.json"), right_scene().dump());
  EXPECT_EQ(simulated({"simulate", in_folder("nameless.json")})["scene"], "nameless");
}

TEST_F(Result, OfEitherBackendSaysWhichOneItWas) {
  EXPECT_EQ(simulated({"simulate", scene("s-curve-32"), "--backend", "box2d"})["backend"], "box2d");
}

TEST_F(Result, KeepsTheLimitThatWasAskedFor) {
  const std::string n = scene("nuno/n1");
  const Json near = simulated({"optimize", n, "--error-limit", "0.01"});
  EXPECT_LE(near["error"]["relative"].get<double>(), 0.01);
  EXPECT_GT(near["error"]["relative"].get<double>(), 0.0099);
  EXPECT_GT(near["optimization"]["pareto_front"].size(), 10u);
  const Json cheap = simulated({"optimize", n, "--effort-limit", "0.2"});
  EXPECT_LE(cheap["control_effort"].get<double>(), 0.2);
  EXPECT_GT(cheap["control_effort"].get<double>(), 0.199);
  const Json beyond = simulated({"optimize", n, "--error-limit", "0"});
  EXPECT_EQ(beyond["optimization"]["status"], "budget");
}

TEST_F(Result, OfRefinementIsNearerAndSaysHowItCorrected) {
  const std::string n = scene("nuno/n1");
  const Json plain = simulated({"optimize", n});
  const Json refined = simulated({"optimize", n, "--refine"});
  EXPECT_LT(refined["error"]["mean"].get<double>(), 0.7 * plain["error"]["mean"].get<double>());
  EXPECT_LT(refined["control_effort"].get<double>(), plain["control_effort"].get<double>());
  const Json& refinement = refined["optimization"]["refinement"];
  ASSERT_EQ(refined["reference_correction"].size(), 4u);
  for (const Json& offset : refined["reference_correction"]) {
    EXPECT_EQ(offset.size(), refined["final"].size());
  }
  const Json before = simulated({"simulate", n, "--alpha", Json(refined["alpha"]).dump()});
  EXPECT_EQ(refinement["error_before"], before["error"]["mean"]);
}

TEST_F(Result, OfRefinementKeepsTheLimitThatWasAskedFor) {
  const std::string n = scene("nuno/n1");
  const Json exact = simulated({"optimize", n, "--refine"});
  const double effort = 0.5 * exact["control_effort"].get<double>();
  const Json cheap = simulated({"optimize", n, "--refine", "--effort-limit", Json(effort).dump()});
  EXPECT_LE(cheap["control_effort"].get<double>(), effort);
  EXPECT_GT(cheap["control_effort"].get<double>(), 0.8 * effort);
  const Json near = simulated({"optimize", n, "--refine", "--error-limit", "0.01"});
  EXPECT_LE(near["error"]["relative"].get<double>(), 0.01);
  EXPECT_LT(near["control_effort"].get<double>(), exact["control_effort"].get<double>());
}

TEST_F(Result, OfOptimizeIsTheRolloutThatSimulateGivesAtItsGain) {
  for (const char* optimizer : {"global", "steepest-descent"}) {
    const Json best = simulated({"optimize", scene("s-curve-32"), "--optimizer", optimizer});
    const Json again =
        simulated({"simulate", scene("s-curve-32"), "--alpha", Json(best["alpha"]).dump()});
    EXPECT_EQ(best["final"], again["final"]) << optimizer;
    EXPECT_EQ(best["error"], again["error"]) << optimizer;

    const Json& optimization = best["optimization"];
    EXPECT_EQ(optimization["optimizer"], optimizer);
    EXPECT_EQ(optimization["status"], "converged");
    EXPECT_GT(optimization["seconds"].get<double>(), 0);
    EXPECT_GE(optimization["evaluations"].get<std::size_t>(), optimization["history"].size());
    double least = HUGE_VAL;
    for (const Json& entry : optimization["history"]) {
      least = std::min(least, entry["error"].get<double>());
    }
    EXPECT_NEAR(least, best["error"]["mean"].get<double>(), 1e-12) << optimizer;
  }
}

TEST_F(Result, OfARobustSearchHasTheMeanErrorOverFiveStarts) {
  const Json best = simulated({"optimize", scene("s-curve-32"), "--robust"});
  const Json& optimization = best["optimization"];
  EXPECT_EQ(optimization["evaluations"].get<int>() % 5, 0);
  // Calm, so that a perturbation of a thousandth changes little.
  EXPECT_NEAR(optimization["robust_error"].get<double>(), best["error"]["mean"].get<double>(),
              1e-3);
  EXPECT_LT(best["sensitivity"], 20);
}

TEST_F(Result, SaysInWordsThatAnAnswerIsFragile) {
  const Outcome fragile = nuno({"simulate", scene("letter-z"), "--alpha", "0.4"});
  EXPECT_NE(fragile.out.find("fragile: a change at the start grows "), std::string::npos)
      << fragile.out;
  const Outcome calm = nuno({"simulate", scene("s-curve-32"), "--alpha", "0.0181"});
  EXPECT_EQ(calm.out.find("fragile"), std::string::npos) << calm.out;
  EXPECT_GT(simulated({"simulate", scene("letter-z"), "--alpha", "0.4"})["sensitivity"], 1000);
}

TEST_F(Result, OfAGainTooLargeForTheDefaultStepTakesAShorterOne) {
  const Json calm = simulated({"simulate", scene("s-curve-32")});
  const Json strong = simulated({"simulate", scene("s-curve-32"), "--alpha", "1000"});
  EXPECT_LT(strong["time_step"].get<double>(), calm["time_step"].get<double>());
}

/// A stiff thread that its control folds up within a few segments.
const Json vee_scene = {{"nuno_scene", 1},
                        {"particles", 16},
                        {"arrival_time", 1},
                        {"gravity", 0},
                        {"initial", {{0, 1}, {1, 1}}},
                        {"target", {{0, 0}, {0.5, 0.1}, {0, 0.2}}},
                        {"cloth", {{"stretch_stiffness", 2e4}, {"air_drag", 0}}}};

TEST_F(Result, IsFlownInShorterStepsWhereThoseOfTheEngineDiverge) {
  const std::string vee = in_folder("vee.json");
  write_text(vee, vee_scene.dump());
  const Outcome run = nuno({"simulate", vee, "--alpha", "5", "--out", output("result.json")});
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_NE(run.out.find("it diverges in 800 steps of 1.25 ms"), std::string::npos) << run.out;
  const Json result = read_json(output("result.json"));
  EXPECT_GE(result["steps"], 4 * 800);
  // The bound of energy: about the centroid, control is conservative from rest.
  EXPECT_LT(result["max_strain"], 0.1);
}

TEST_F(Result, TellsHowFarItMovesWithHalfOfTheStepAndWhichResolvesIt) {
  Json scene = read_json(scenes / "hanging-to-arch-32.json");
  scene["cloth"]["stretch_stiffness"] = 2e5;
  scene["cloth"]["hinge_stiffness"] = 1e-5;
  const auto flown = [&]() -> std::pair<Json, std::string> {
    const std::string path = in_folder("scene.json");
    write_text(path, scene.dump());
    const Outcome run = nuno({"simulate", path, "--out", "-"});
    EXPECT_EQ(run.status, 0) << run.err;
    return {Json::parse(run.out), run.err};
  };
  const auto [coarse, words] = flown();
  ASSERT_TRUE(coarse.contains("step_error"));
  EXPECT_GT(coarse["step_error"], 1e-3);
  const std::string asked = "a time step of ";
  const std::size_t at = words.find(asked);
  ASSERT_NE(at, std::string::npos) << words;
  scene["time_step"] = std::stod(words.substr(at + asked.size()));
  const auto [fine, calm_words] = flown();
  EXPECT_LT(fine.value("step_error", 0.0), 1e-3);
  EXPECT_EQ(calm_words.find("coarse"), std::string::npos) << calm_words;
}

TEST_F(Result, JudgesTheStepOfARefinedFlightByItsOwnReference) {
  // Against the reference without its correction it would be some per cent.
  const Json refined = simulated({"optimize", scene("s-curve-32"), "--refine"});
  ASSERT_TRUE(refined["optimization"].contains("refinement"));
  ASSERT_TRUE(refined.contains("step_error"));
  EXPECT_LT(refined["step_error"], 2e-3);
}

TEST_F(Result, OfARolloutThatDivergesIsExitStatusThreeAndNoFile) {
  const std::string vee = in_folder("vee.json");
  Json scene = vee_scene;
  scene["time_step"] = 1.25e-3;  // is kept
  write_text(vee, scene.dump());
  const Outcome run = nuno({"simulate", vee, "--alpha", "5", "--out", output("result.json")});
  EXPECT_EQ(run.status, 3);
  EXPECT_EQ(run.out, "");
  EXPECT_TRUE(is_one_line(run.err)) << run.err;
  EXPECT_NE(run.err.find("vee.json: diverged on native at α = "), std::string::npos) << run.err;
  EXPECT_NE(run.err.find(" in step "), std::string::npos) << run.err;
  EXPECT_NE(run.err.find("a segment is a thousand times its length"), std::string::npos) << run.err;
  EXPECT_TRUE(outputs().empty());
}

}  // namespace
}  // namespace nuno
