// nuno compare, as a script sees it.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "program.h"

namespace nuno {
namespace {

class ComparisonOfEngines : public Program {
 protected:
  /// A folder of two small scenes, so that a comparison takes little time.
  fs::path two_scenes() const {
    const fs::path folder = in_folder("scenes");
    fs::create_directory(folder);
    Json first = right_scene();
    first["particles"] = 5;
    first["time_step"] = 0.005;
    Json second = first;
    first["name"] = "flat";
    second["name"] = "soft";
    second["cloth"]["hinge_stiffness"] = 1e-4;
    write_text(folder / "b.json", second.dump());
    write_text(folder / "a.json", first.dump());
    write_text(folder / "notes.txt", "no scene");
    return folder;
  }
};

TEST_F(ComparisonOfEngines, OfAFolderHasItsScenesInAlphabeticalOrder) {
  const Outcome run = nuno({"compare", two_scenes(), "--out", output("a/b")});
  ASSERT_EQ(run.status, 0) << run.err;
  const Json comparison = read_json(output("a/b/compare.json"));
  EXPECT_EQ(comparison["nuno_comparison"], 1);
  ASSERT_EQ(comparison["scenes"].size(), 2u);
  EXPECT_EQ(comparison["scenes"][0]["scene"], "flat");
  EXPECT_EQ(comparison["scenes"][1]["scene"], "soft");
  for (const char* figure :
       {"01-flat-gain", "01-flat-pareto-front", "01-flat-flight", "02-soft-gain"}) {
    const fs::path file = output("a/b/figures") / (std::string(figure) + ".svg");
    EXPECT_TRUE(fs::exists(file)) << file;
  }
}

TEST_F(ComparisonOfEngines, HasEveryFieldAndACommonCurve) {
  const Json comparison = simulated({"compare", two_scenes() / "a.json"});
  const Json& entry = comparison["scenes"][0];
  ASSERT_EQ(entry["rows"].size(), 2u);
  EXPECT_EQ(entry["rows"][0]["backend"], "native");
  EXPECT_EQ(entry["rows"][1]["backend"], "box2d");
  for (const Json& row : entry["rows"]) {
    for (const char* field :
         {"launch_only_error", "alpha", "error", "max_error", "centroid_error", "control_effort",
          "max_strain", "sensitivity", "evaluations", "seconds", "error_with_the_other_alpha"}) {
      EXPECT_TRUE(row[field].is_number()) << field;
    }
    EXPECT_LE(row["error"], row["launch_only_error"]) << "gain 0 is among the gains it tries";
  }
  EXPECT_EQ(entry["shape_difference"]["at_alpha"], entry["rows"][0]["alpha"]);
  EXPECT_LE(entry["shape_difference"]["mean"], entry["shape_difference"]["max"]);

  const Json& curve = entry["alpha_curve"];
  ASSERT_EQ(curve["alpha"].size(), curve["native"].size());
  ASSERT_EQ(curve["alpha"].size(), curve["box2d"].size());
  EXPECT_TRUE(std::is_sorted(curve["alpha"].begin(), curve["alpha"].end()));
  EXPECT_EQ(curve["alpha"][0], 0.0);
  for (const std::size_t engine : {0u, 1u}) {
    const Json& row = entry["rows"][engine];
    const Json& efforts = curve["control_effort"][row["backend"].get<std::string>()];
    ASSERT_EQ(efforts.size(), curve["alpha"].size());
    EXPECT_EQ(efforts[0], 0.0);
    constexpr std::size_t one = 40;
    const Json flight =
        simulated({"simulate", in_folder("scenes") / "a.json", "--backend",
                   row["backend"].get<std::string>(), "--alpha", curve["alpha"][one].dump()});
    EXPECT_EQ(efforts[one], flight["control_effort"]);
    EXPECT_EQ(curve[row["backend"].get<std::string>()][one], flight["error"]["mean"]);
  }
  EXPECT_NEAR(curve["native"][0].get<double>(), entry["rows"][0]["launch_only_error"].get<double>(),
              1e-12);
}

TEST_F(ComparisonOfEngines, FindsOnNativeWhatOptimizeFinds) {
  const fs::path file = two_scenes() / "a.json";
  Json scene = Json::parse(std::ifstream(file));
  scene["reference"] = "morph";
  scene["damping_ratio"] = 0.7;
  write_text(file, scene.dump());
  const Json comparison = simulated({"compare", file});
  const Json best = simulated({"optimize", file});
  const Json& row = comparison["scenes"][0]["rows"][0];
  EXPECT_EQ(row["alpha"], best["alpha"]);
  EXPECT_EQ(row["error"], best["error"]["mean"]);
  EXPECT_EQ(row["evaluations"], best["optimization"]["evaluations"]);
}

TEST_F(ComparisonOfEngines, EndsWithoutDampingWhereBothEnginesAreCalm) {
  const std::string file = scene("s-curve-32");
  const Json cloth = Json::parse(std::ifstream(file));
  const double t0 = cloth["arrival_time"];
  const double mass = cloth["cloth"]["mass"].get<double>() / 32;
  const Json rows = simulated({"compare", file})["scenes"][0]["rows"];
  for (const Json& row : rows) EXPECT_LE(row["alpha"], 100.0001 * mass / (t0 * t0));
  EXPECT_GT(simulated({"optimize", file})["alpha"], 100.0001 * mass / (t0 * t0));
}

TEST_F(ComparisonOfEngines, ShowsATableOfALineForEachEngine) {
  const Outcome run = nuno({"compare", two_scenes()});
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(run.err, "");
  for (const char* word : {"launch only", "best α", "error", "evaluations", "time", "flat", "soft",
                           "2 scenes are well-conditioned"}) {
    EXPECT_NE(run.out.find(word), std::string::npos) << word;
  }
}

}  // namespace
}  // namespace nuno
