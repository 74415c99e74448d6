// What is wrong with a sheet's scene is refused at the door.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "sheet_refusal.h"

namespace nuno {
namespace {

struct BadScene {
  std::string name;
  std::string text;
  std::string pointer;  ///< of the field that the message names
  std::string value;    ///< that it shows
  std::string rule;     ///< that it says was broken
};

void PrintTo(const BadScene& bad, std::ostream* out) { *out << bad.name; }

std::string with(const std::string& pointer, const Json& value) {
  Json scene = sheet_scene();
  scene[Json::json_pointer(pointer)] = value;
  return scene.dump();
}

std::vector<BadScene> bad_scenes() {
  const auto polyline = Json::parse("[[0, 1], [1, 1]]");
  return {
      {"ParticlesGiven", with("/particles", 9), "/particles", "\"particles\"",
       "is not a known field"},
      {"UnknownMaterial", with("/material", "velvet"), "/material", "\"velvet\"",
       "is not one of cotton, silk, denim, wool"},
      {"MaterialIsANumber", with("/material", 3), "/material", "3", "is not a string"},
      {"UnknownRest", with("/rest", "curved"), "/rest", "\"curved\"",
       "is not \"initial\" or \"flat\""},
      {"RestIsANumber", with("/rest", 0), "/rest", "0", "is not \"initial\" or \"flat\""},
      {"MeshIsANumber", with("/initial", 5), "/initial", "5", "is not an array of points"},
      {"MeshIsNull", with("/target", nullptr), "/target", "null", "is not a string"},
      {"MeshAndPolyline", with("/target", polyline), "/target", "[[0.0,1.0],[1.0,1.0]]",
       "is not a string"},
      {"PolylineAndMesh", with("/initial", polyline), "/target", "\"target.obj\"",
       "is not an array of points"},
      {"MaterialOfAChain", replaced(with("/material", "silk"), "\"start.obj\"", "[[0,1],[1,1]]"),
       "/material", "\"material\"", "is not a known field"},
      {"MassOfAChain", with("/cloth/mass", 0.1), "/cloth/mass", "\"mass\"", "is not a known field"},
      {"NoDensity", with("/cloth/areal_density", 0), "/cloth/areal_density", "0", "is not > 0"},
      {"NegativeDensity", with("/cloth/areal_density", -1), "/cloth/areal_density", "-1",
       "is not > 0"},
      {"NegativeDrag", with("/cloth/air_drag", -1), "/cloth/air_drag", "-1", "is not >= 0"},
      {"DragLikeStone", with("/cloth/air_drag", 1e9), "/cloth/air_drag", "1000000000", "<= 700"},
      {"NoStretchStiffness", with("/cloth/stretch_stiffness", 0), "/cloth/stretch_stiffness", "0",
       "is not > 0"},
      {"NegativeStretchDamping", with("/cloth/stretch_damping", -1), "/cloth/stretch_damping", "-1",
       "is not >= 0"},
      {"NegativeShearStiffness", with("/cloth/shear_stiffness", -1), "/cloth/shear_stiffness", "-1",
       "is not >= 0"},
      {"NegativeShearDamping", with("/cloth/shear_damping", -1), "/cloth/shear_damping", "-1",
       "is not >= 0"},
      {"NegativeBendingStiffness", with("/cloth/bending_stiffness", -1), "/cloth/bending_stiffness",
       "-1", "is not >= 0"},
      {"NegativeBendingDamping", with("/cloth/bending_damping", -1), "/cloth/bending_damping", "-1",
       "is not >= 0"},
      {"StiffnessBeyondCloth", with("/cloth/stretch_stiffness", 1e13), "/cloth/stretch_stiffness",
       "10000000000000", "is not within"},
      {"StiffnessInWords", with("/cloth/stretch_stiffness", "high"), "/cloth/stretch_stiffness",
       "\"high\"", "is not a number"},
      {"DensityBeyondDoubles", replaced(with("/cloth/areal_density", 7), "7", "1e400"), "/",
       "1e400", ""},
      {"ClothIsAList", with("/cloth", Json::array()), "/cloth", "[]", "is not an object"},
      {"ArrivalTimeOfZero", with("/arrival_time", 0), "/arrival_time", "0", "is not > 0"},
      {"NegativeGravity", with("/gravity", -9.8), "/gravity", "-9.8", "is not >= 0"},
      {"NegativeDampingRatio", with("/damping_ratio", -0.7), "/damping_ratio", "-0.7",
       "is not >= 0"},
      {"UnknownReference", with("/reference", "fade"), "/reference", "\"fade\"", "\"morph\""},
      {"UnknownArrival", with("/arrival", "stop"), "/arrival", "\"stop\"", "\"settle\""},
      {"TimeStepOfZero", with("/time_step", 0), "/time_step", "0", "is not > 0"},
      {"TimeStepThatTakesDays", with("/time_step", 1e-12), "/time_step", "1e-12", "is not >= "},
      {"NoFrames", with("/frames_per_second", 0), "/frames_per_second", "0", "is not > 0"},
      {"MoreFramesThanMemory", with("/frames_per_second", 1e12), "/frames_per_second",
       "1000000000000", "is not <= "},
      {"SoStiffThatItTakesDays", with("/cloth/bending_stiffness", 1e12), "/cloth/bending_stiffness",
       "6.2e+07 steps", "is not <= 50000000"},
      {"MisspelledField", with("/materiel", "silk"), "/materiel", "\"materiel\"",
       "the nearest is \"material\""},
      {"MisspelledClothField", with("/cloth/bending", 1), "/cloth/bending", "\"bending\"",
       "is not a known field"},
  };
}

class MalformedSheetScene : public SheetRefusal, public testing::WithParamInterface<BadScene> {};

TEST_P(MalformedSheetScene, IsRefusedInOneLineThatSaysWhereAndWhyAndTouchesNoOutput) {
  const BadScene& bad = GetParam();
  write_meshes(square, square);
  const std::string file = in_folder("bad.json").string();
  write_text(file, bad.text);
  for (const char* command : {"simulate", "optimize"}) {
    expect_refused({command, file}, "flight.glb", file + ": " + bad.pointer + ": ", bad.value,
                   bad.rule);
  }
}

INSTANTIATE_TEST_SUITE_P(EachOf, MalformedSheetScene, testing::ValuesIn(bad_scenes()),
                         [](const auto& bad) { return bad.param.name; });

TEST_F(SheetRefusal, OfWhatSheetsCannotHaveNamesTheSceneAndTheRule) {
  write_meshes(square, square);
  const std::string sheet = in_folder("sheet.json"), chain = in_folder("chain.json");
  write_text(sheet, sheet_scene().dump());
  write_text(chain, right_scene().dump());
  expect_refused({"simulate", sheet, "--backend", "box2d"}, "a.json", sheet + ": ",
                 "box2d does not fly a sheet", "those that do: native, bullet");
  expect_refused({"optimize", sheet, "--backend", "box2d"}, "a.json", sheet + ": ",
                 "box2d does not fly a sheet", "those that do: native, bullet");
  expect_refused({"simulate", chain, "--backend", "bullet"}, "a.json", chain + ": ",
                 "bullet does not fly a chain", "those that do: native, box2d");
  expect_refused({"optimize", sheet, "--coefficients", "3"}, "a.json", sheet + ": /initial: ", "9",
                 "vertices are not >= 14, the fewest for 3 coefficients");
  expect_refused({"simulate", sheet, "--alpha", "1,2,3,4"}, "a.json", sheet + ": /initial: ", "9",
                 "the fewest for 4 coefficients");
  expect_refused({"simulate", sheet, "--ribbon-width", "0.1"}, "a.glb", "--ribbon-width: ", sheet,
                 "is for a chain");
  expect_refused({"simulate", sheet, "--tail", "1"}, "a.json", "--tail: ", "",
                 "is for an animation");
  expect_refused({"simulate", sheet}, "a.obj", "--out: ", "a.obj", "has no # in its name");
}

}  // namespace
}  // namespace nuno
