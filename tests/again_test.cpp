// A result stands alone: on whatever engine it was flown and however its gain was found, simulate
// flies it again to the last bit.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "program.h"

namespace nuno {
namespace {

class Again : public Program {
 protected:
  /// The result of these arguments, in a folder with nothing else.
  fs::path result_of(std::vector<std::string> arguments, const std::string& name) const {
    const fs::path path = output(name);
    arguments.insert(arguments.end(), {"--out", path});
    const Outcome run = nuno(arguments);
    EXPECT_EQ(run.status, 0) << run.err;
    return path;
  }

  /// That simulating the result of these arguments gives it again, all but how it was found; and
  /// simulating that once more, too.
  void expect_again(const std::vector<std::string>& arguments) const {
    Json first = read_json(result_of(arguments, "first.json"));
    first.erase("optimization");
    fs::path last = output("first.json");
    for (const char* name : {"second.json", "third.json"}) {
      last = result_of({"simulate", last}, name);
      const Json again = read_json(last);
      for (const auto& [field, value] : first.items()) {
        EXPECT_TRUE(again.contains(field) && again[field] == value) << field << " in " << name;
      }
      EXPECT_EQ(again.size(), first.size());
    }
  }

  /// Draws in the output folder; `with` are fields that the scene has besides.
  fs::path small_scene(const Json& with = {}) const {
    Json json = right_scene();
    if (!with.is_null()) json.update(with);
    write_text(in_folder("small.json"), json.dump());
    return in_folder("small.json");
  }
};

TEST_F(Again, FliesEveryChainOfTheDemos) {
  for (const fs::path& folder : {scenes, scenes / "nuno"}) {
    for (const auto& entry : fs::directory_iterator(folder)) {
      if (entry.path().extension() != ".json") continue;
      SCOPED_TRACE(entry.path());
      expect_again({"simulate", entry.path(), "--alpha", "0.0123"});
    }
  }
}

TEST_F(Again, FliesEverySheetOfTheDemos) {
  for (const auto& entry : fs::directory_iterator(scenes / "sheets")) {
    if (entry.path().extension() != ".json") continue;
    SCOPED_TRACE(entry.path());
    expect_again({"simulate", entry.path(), "--alpha", "0.0123"});
  }
}

TEST_F(Again, FliesOnTheEngineOfTheResult) {
  expect_again({"simulate", scene("s-curve-32"), "--alpha", "0.02", "--backend", "box2d"});
  expect_again({"simulate", scene("sheets/napkin-over-an-edge"), "--backend", "bullet"});
}

TEST_F(Again, FliesInTheStepsOfTheResult) {
  expect_again({"simulate", small_scene(), "--time-step", "0.00037"});
  expect_again({"simulate", small_scene(), "--alpha", "900"});  // which takes a shorter step
}

TEST_F(Again, FliesWhatASearchFound) {
  const Json damped = {{"reference", "morph"}, {"damping_ratio", 0.7}};
  expect_again({"optimize", scene("hanging-to-arch-32")});
  expect_again({"optimize", small_scene(), "--optimizer", "steepest-descent"});
  expect_again({"optimize", small_scene(damped), "--error-limit", "0.05"});
  expect_again({"optimize", small_scene(), "--coefficients", "3"});
  expect_again({"optimize", small_scene(), "--robust"});
}

TEST_F(Again, FliesWhatWasRefined) {
  for (const char* engine : {"native", "box2d"}) {
    expect_again({"optimize", scene("nuno/n1"), "--refine", "--backend", engine});
    EXPECT_EQ(read_json(output("third.json"))["reference_correction"].size(), 4u) << engine;
  }
}

TEST_F(Again, FliesWhatWasThrownWithoutItsFiles) {
  write_text(in_folder("start.csv"), "0,1\n1,1\n");
  write_text(in_folder("end.csv"), "2,1\n2.5,1.3\n3,1\n");
  const fs::path chain = result_of(
      {"throw", in_folder("start.csv"), in_folder("end.csv"), "--time", "0.5"}, "chain.json");
  const std::string flag = (scenes / "sheets/flag-to-half-pipe").string();
  for (const char* end : {"start", "target"}) {
    fs::copy(flag + "-" + end + ".obj", in_folder(std::string(end) + ".obj"));
  }
  const fs::path sheet = result_of(
      {"throw", in_folder("start.obj"), in_folder("target.obj"), "--time", "1"}, "sheet.json");
  for (const char* name : {"start.csv", "end.csv", "start.obj", "target.obj"}) {
    fs::remove(in_folder(name));
  }
  for (const fs::path& result : {chain, sheet}) {
    const Json again = read_json(result_of({"simulate", result}, "again.json"));
    EXPECT_TRUE(again["frames"] == read_json(result)["frames"]) << result;
  }
}

TEST_F(Again, MakesTheSameAnimationAsTheScene) {
  // Texture coordinates with a seam, in a file whose vertices are written several times there.
  write_text(in_folder("start.ply"), R"(ply
format ascii 1.0
element vertex 6
property float x
property float y
property float z
property float s
property float t
element face 2
property list uchar int vertex_indices
end_header
0 0 0 0 0
1 0 0 1 0
1 1 0 1 1
0 0 0 0.5 0
1 1 0 0.5 1
0 1 0 0 1
3 0 1 2
3 3 4 5
)");
  write_text(
      in_folder("scene.json"),
      R"({"nuno_scene": 1, "arrival_time": 1, "initial": "start.ply", "target": "start.ply"})");
  const fs::path scene = in_folder("scene.json");
  const fs::path result = result_of({"simulate", scene, "--alpha", "0.5"}, "result.json");
  EXPECT_EQ(read_json(result)["input"]["initial"]["file_vertices"].size(), 6u)
      << "not welded: no test";
  for (const char* kind : {".glb", ".usda", ".pc2"}) {
    const std::string of_scene = std::string("scene") + kind, again = std::string("again") + kind;
    result_of({"simulate", scene, "--alpha", "0.5", "--tail", "0.5"}, of_scene);
    result_of({"simulate", result, "--tail", "0.5"}, again);
    EXPECT_TRUE(read_text(output(of_scene)) == read_text(output(again))) << kind;
  }
}

TEST_F(Again, FliesOtherwiseWhereThatIsAsked) {
  const fs::path scene = small_scene();
  const fs::path result = result_of({"simulate", scene, "--alpha", "0.02"}, "result.json");
  const std::vector<std::vector<std::string>> changes = {
      {"--alpha", "0.01"}, {"--backend", "box2d"}, {"--time-step", "0.0002"}};
  for (const auto& change : changes) {
    std::vector<std::string> of_scene = {"simulate", scene, "--alpha", "0.02"};
    if (change[0] == "--alpha") of_scene.resize(2);
    std::vector<std::string> of_result = {"simulate", result};
    of_scene.insert(of_scene.end(), change.begin(), change.end());
    of_result.insert(of_result.end(), change.begin(), change.end());
    EXPECT_TRUE(simulated(of_result) == simulated(of_scene)) << change[0];
  }
}

TEST_F(Again, AResultIsASceneForEveryCommand) {
  const fs::path scene = small_scene();
  const fs::path result = result_of({"optimize", scene}, "result.json");
  Json first = read_json(result), again = read_json(result_of({"optimize", result}, "again.json"));
  EXPECT_EQ(again["alpha"], first["alpha"]);
  EXPECT_TRUE(again["frames"] == first["frames"]);
}

TEST_F(Again, RefusesAResultThatIsNotWhole) {
  const Json whole = read_json(result_of({"simulate", small_scene()}, "whole.json"));
  const auto expect = [&](const char* pointer, const Json& value, const std::string& field,
                          const std::string& shown, const std::string& rule) {
    Json broken = whole;
    broken[Json::json_pointer(pointer)] = value;
    if (value.is_null()) broken.erase(pointer + 1);
    write_text(in_folder("broken.json"), broken.dump());
    expect_refusal(nuno({"simulate", in_folder("broken.json")}),
                   in_folder("broken.json").string() + ": " + field + ": ", shown, rule);
  };
  expect("/nuno_result", 2, "/nuno_result", "2", "is not 1");
  expect("/input", nullptr, "/input", "", "is missing");
  expect("/input/cloth/mass", -1, "/input/cloth/mass", "-1", "is not > 0");
  expect("/input", 5, "/input", "5", "is not an object");
  expect("/backend", "fast", "/backend", "fast", "is not one of native");
  expect("/alpha", -1, "/alpha", "-1", "is not a number >= 0");
  expect("/alphas", Json::array(), "/alphas", "[]", "is not a list of 1 … 4 gains");
  expect("/steps", 0.5, "/steps", "0.5", "is not a whole number >= 1");
  expect("/reference_correction", {1, 2, 3, 4}, "/reference_correction/0", "1", "is not a shape");
  expect("/reference_correction", {1, 2}, "/reference_correction", "[1,2]", "is not a list of 4");
  expect("/reference_correction", Json(4, {{0, 0}, {1, 1}}), "/reference_correction/0",
         "[[0.0,0.0]", "is not a shape of 8 particles");
}

TEST_F(Again, RefusesASheetThatIsNotWhole) {
  const Json whole = read_json(
      result_of({"simulate", scene("sheets/napkin-over-an-edge")}, "whole.json"))["input"];
  const auto expect = [&](const char* pointer, const Json& value, const std::string& field,
                          const std::string& shown, const std::string& rule) {
    Json broken = whole;
    broken[Json::json_pointer(pointer)] = value;
    write_text(in_folder("broken.json"), broken.dump());
    expect_refusal(nuno({"simulate", in_folder("broken.json")}),
                   in_folder("broken.json").string() + ": " + field + ": ", shown, rule);
  };
  write_text(in_folder("whole.json"), whole.dump());
  EXPECT_EQ(nuno({"simulate", in_folder("whole.json")}).status, 0) << "a scene of its own";
  expect("/initial/faces", 1, "/initial/faces", "1", "is not a list of faces");
  expect("/initial/faces/3", {0, 1, 1e6}, "/initial/faces/3", "1000000",
         "is not a whole number within 0 …");
  expect("/initial/faces/3", {0, 1}, "/initial/faces/3", "2 corners", "are not 3 or 4");
  expect("/initial/vertices", {{0, 0}, {1, 1}}, "/initial/vertices/0", "2 numbers", "are not 3");
  expect("/target/vertices", {{0, 0, 1}, {1, 1, 1}}, "/target", "2 vertices", "of /initial");
  expect("/initial/file_vertices", {-1}, "/initial/file_vertices", "-1", "is not a whole number");
}

}  // namespace
}  // namespace nuno
