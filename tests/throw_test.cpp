// nuno throw, and sheets in the other commands, as an animator sees them.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "glb_file.h"
#include "program.h"

namespace nuno {
namespace {

const std::string strip = NUNO_TEST_DATA "/sheets/textured-strip";

Points points(const Json& columns) {
  Points result(3, static_cast<Index>(columns.size()));
  for (std::size_t i = 0; i < columns.size(); ++i) {
    for (std::size_t row = 0; row < 3; ++row) {
      result(static_cast<Index>(row), static_cast<Index>(i)) = columns[i][row];
    }
  }
  return result;
}

class Throw : public Program {
 protected:
  /// The strip thrown with these further options.
  Outcome thrown(std::vector<std::string> options) const {
    options.insert(options.begin(),
                   {"throw", strip + "-start.obj", strip + "-target.obj", "--time", "0.73"});
    return nuno(options);
  }
  Json result_of(std::vector<std::string> options = {}) const {
    options.insert(options.end(), {"--out", "-"});
    const Outcome run = thrown(options);
    EXPECT_EQ(run.status, 0) << run.err;
    return Json::parse(run.out);
  }
};

TEST_F(Throw, WritesAResultOfASheet) {
  const Json result = result_of();
  EXPECT_EQ(result["nuno_result"], 1);
  EXPECT_EQ(result["kind"], "sheet");
  EXPECT_EQ(result["scene"], "textured-strip-target");
  EXPECT_EQ(result["backend"], "native");
  EXPECT_EQ(result["status"], "ok");
  EXPECT_FALSE(result.contains("cloth_length"));
  EXPECT_NEAR(result["size"].get<double>(), std::sqrt(0.6 * 0.4), 1e-12);
  EXPECT_GT(result["alpha"], 0.0);
  EXPECT_EQ(result["optimization"]["status"], "converged");
  // A hexagon in four, three quads, two triangles.
  ASSERT_EQ(result["faces"].size(), 4u + 3 + 2);
  std::set<Index> corners;
  for (const auto& face : result["faces"]) {
    EXPECT_TRUE(face.size() == 3 || face.size() == 4);
    for (const auto& corner : face) corners.insert(corner.get<Index>());
  }
  EXPECT_EQ(corners.size(), 12u);
  for (const char* field : {"launch_velocity", "target", "final"}) {
    ASSERT_EQ(result[field].size(), 12u) << field;
    EXPECT_EQ(result[field][0].size(), 3u) << field;
  }

  const Points final = points(result["final"]), target = points(result["target"]);
  const Eigen::VectorXd gaps = (final - target).colwise().norm();
  EXPECT_NEAR(result["error"]["mean"].get<double>(), gaps.mean(), 1e-15);
  EXPECT_NEAR(result["error"]["max"].get<double>(), gaps.maxCoeff(), 1e-15);
  EXPECT_LT(result["error"]["relative"].get<double>(), 0.003) << "the project's bar";
  EXPECT_LT(result["error"]["centroid"].get<double>(), 1e-9 * result["size"].get<double>());
  EXPECT_EQ(result["frames"]["times"].back(), 0.73);
  EXPECT_EQ(result["frames"]["positions"].back(), result["final"]);
}

TEST_F(Throw, WritesTheSameFlightAsAnAnimatedMesh) {
  const Json result = result_of({"--frames-per-second", "24"});
  ASSERT_EQ(thrown({"--frames-per-second", "24", "--out", output("flight.glb")}).status, 0);
  const GlbFile file(read_text(output("flight.glb")));
  const Json& times = result["frames"]["times"];
  ASSERT_EQ(times.size(), 1u + 17 + 1);  // 0.73 s · 24 = 17.5
  ASSERT_EQ(file.frames(), times.size());
  const Points keys = file.sampler("input");
  for (std::size_t k = 0; k < times.size(); ++k) {
    EXPECT_EQ(keys(0, static_cast<Index>(k)), times[k].get<float>());
    const Points expected = points(result["frames"]["positions"][k]);
    const Points found = file.at_frame("POSITION", k);
    ASSERT_EQ(found.cols(), 12 + 3) << "the seam's vertices stand twice";
    EXPECT_LT((found.leftCols(12) - expected).cwiseAbs().maxCoeff(), 2e-7) << "frame " << k;
    for (const Index twin : {12, 13, 14}) {
      EXPECT_EQ((found.leftCols(12).colwise() - found.col(twin)).colwise().norm().minCoeff(), 0)
          << "the seam must not open";
    }
  }
  EXPECT_EQ(keys(0, keys.cols() - 1), 0.73F);
  EXPECT_TRUE(file.primitive()["attributes"].contains("TEXCOORD_0"));
  EXPECT_EQ(file.json["nodes"][0]["name"], "textured-strip-target");
}

TEST_F(Throw, IsTheDampedMorphAtItsBestGain) {
  const Json scene = {{"nuno_scene", 1},        {"arrival_time", 0.73}, {"reference", "morph"},
                      {"damping_ratio", 0.7},   {"material", "silk"},   {"arrival", "settle"},
                      {"frames_per_second", 30}};
  Json file = scene;
  file["initial"] = strip + "-start.obj";
  file["target"] = strip + "-target.obj";
  write_text(in_folder("strip.json"), file.dump());
  for (const char* backend : {"native", "bullet"}) {
    const Json by_scene = simulated({"optimize", in_folder("strip.json"), "--backend", backend});
    const Json thrown = result_of(
        {"--material", "silk", "--settle", "--frames-per-second", "30", "--backend", backend});
    EXPECT_EQ(thrown["backend"], backend);
    for (const char* field : {"alpha", "error", "final", "frames", "time_step"}) {
      EXPECT_EQ(thrown[field], by_scene[field]) << field << " on " << backend;
    }
  }
}

TEST_F(Throw, ComesNearerRefined) {
  const Json alone = result_of(), refined = result_of({"--refine"});
  const Json& told = refined["optimization"]["refinement"];
  EXPECT_LT(refined["error"]["mean"], 0.5 * alone["error"]["mean"].get<double>());
  EXPECT_EQ(told["jacobians"], 0);
  EXPECT_GT(told["rollouts"], 1);
  const Json& correction = refined["reference_correction"];
  ASSERT_EQ(correction.size(), 4u);
  EXPECT_EQ(correction[0].size(), refined["final"].size());
  EXPECT_EQ(correction[0][0].size(), 3u);
}

TEST_F(Throw, SettlesWhereItIsAskedTo) {
  // How fast the shape still changes as it arrives, about its mean.
  const auto swing = [](const Json& result) {
    const Json& frames = result["frames"];
    const std::size_t last = frames["times"].size() - 1;
    const double span =
        frames["times"][last].get<double>() - frames["times"][last - 1].get<double>();
    const Points rate =
        (points(frames["positions"][last]) - points(frames["positions"][last - 1])) / span;
    return (rate.colwise() - centroid(rate)).norm();
  };
  const std::vector<std::string> fine = {"--frames-per-second", "2000"};
  EXPECT_LT(swing(result_of({"--frames-per-second", "2000", "--settle"})),
            0.2 * swing(result_of(fine)));
}

TEST_F(Throw, TellsErrorForceAndWhetherTheTargetIsCloth) {
  const auto says = [](const Outcome& run, const std::vector<std::string>& words) {
    EXPECT_EQ(run.status, 0) << run.err;
    EXPECT_EQ(run.err, "");
    for (const std::string& word : words) {
      EXPECT_NE(run.out.find(word), std::string::npos) << word << " is not in\n" << run.out;
    }
  };
  says(thrown({}), {"textured-strip-target: 12 particles on native", "gain α", "error", "centroid",
                    "control effort", "of a particle's weight", "strain", "sensitivity",
                    "is a shape that cloth can take"});
  const std::string saddle = (scenes / "sheets" / "tablecloth-to-saddle").string();
  const Outcome run = nuno({"throw", saddle + "-start.obj", saddle + "-target.obj", "--time", "1"});
  says(run, {"error", "control effort", "% too long inside", "comes near, not onto it"});
  EXPECT_EQ(run.out.find("can take"), std::string::npos) << run.out;
}

TEST_F(Throw, KeepsTheSummaryOutOfTheResult) {
  const Outcome run = thrown({"--out", "-"});
  EXPECT_TRUE(Json::accept(run.out));
  EXPECT_NE(run.err.find("control effort"), std::string::npos);
}

TEST_F(Throw, TakesAWholeTargetAnywhere) {
  // A target far off and of another size arrives too: fit scales it, the launch carries it.
  std::string text;
  for (std::string line : {"v 100 3 -50", "v 103 3 -50", "v 103 3 -47", "v 100 3 -47"}) {
    text += line + "\n";
  }
  write_text(in_folder("a.obj"), "v 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 0 1\nf 1 2 3 4\n");
  write_text(in_folder("b.obj"), text + "f 1 2 3 4\n");
  const Json result = simulated({"throw", in_folder("a.obj"), in_folder("b.obj"), "--time", "2"});
  EXPECT_NEAR(result["target_scale"].get<double>(), 1.0 / 3, 1e-12);
  EXPECT_LT(result["error"]["max"].get<double>(), 1e-9);
}

class SheetResult : public Program {};

TEST_F(SheetResult, OfSimulateIsTheFlightOfASceneAtOneGain) {
  const std::string sheet = scene("sheets/tablecloth-to-saddle");
  const Json result = simulated({"simulate", sheet, "--alpha", "0.02"});
  EXPECT_EQ(result["kind"], "sheet");
  EXPECT_EQ(result["alpha"], 0.02);
  EXPECT_FALSE(result.contains("optimization"));
  const Json scene = read_json(sheet);
  EXPECT_EQ(result["scene"], scene["name"]);
  EXPECT_EQ(result["frames"]["times"].back(), scene["arrival_time"]);
  EXPECT_EQ(nuno({"simulate", sheet, "--alpha", "0.02", "--out", output("a.glb")}).status, 0);
  const GlbFile file(read_text(output("a.glb")));
  const Points found = file.at_frame("POSITION", file.frames() - 1);
  EXPECT_LT((found - points(result["final"])).cwiseAbs().maxCoeff(), 1e-6);
}

TEST_F(SheetResult, ComparesChainsAndSheetsSideBySide) {
  Json chain = right_scene();
  chain["particles"] = 5;
  chain["time_step"] = 0.005;
  write_text(in_folder("chain.json"), chain.dump());
  write_text(in_folder("sheet.json"), Json({{"nuno_scene", 1},
                                            {"arrival_time", 0.5},
                                            {"initial", strip + "-start.obj"},
                                            {"target", strip + "-target.obj"},
                                            {"reference", "morph"},
                                            {"damping_ratio", 0.7}})
                                          .dump());
  const Outcome run = nuno(
      {"compare", in_folder("chain.json"), in_folder("sheet.json"), "--out", output("comparison")});
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(run.err, "");
  const Json comparison = read_json(output("comparison/compare.json"));
  ASSERT_EQ(comparison["scenes"].size(), 2u);
  const std::vector<std::vector<std::string>> engines = {{"native", "box2d"}, {"native", "bullet"}};
  for (std::size_t i = 0; i < 2; ++i) {
    const Json& entry = comparison["scenes"][i];
    EXPECT_EQ(entry["scene"], i == 0 ? "chain" : "sheet");
    ASSERT_EQ(entry["rows"].size(), 2u);
    for (std::size_t k = 0; k < 2; ++k) {
      const std::string name = entry["rows"][k]["backend"];
      EXPECT_EQ(name, engines[i][k]);
      EXPECT_EQ(entry["alpha_curve"][name].size(), entry["alpha_curve"]["alpha"].size());
      EXPECT_NE(run.out.find(name), std::string::npos);
    }
  }
  const Json& sheet = comparison["scenes"][1];
  EXPECT_LT(sheet["shape_difference"]["max"].get<double>(), 1e-3) << "the project's bar";
  // The figures of a sheet are in its own row, and it is the flight that optimize finds.
  const Json best = simulated({"optimize", in_folder("sheet.json")});
  EXPECT_EQ(sheet["rows"][0]["alpha"], best["alpha"]);
  EXPECT_EQ(sheet["rows"][0]["error"], best["error"]["mean"]);
  for (const char* file : {"report.html", "figures/02-sheet-gain.svg"}) {
    EXPECT_TRUE(fs::exists(output("comparison") / file)) << file;
  }
}

}  // namespace
}  // namespace nuno
