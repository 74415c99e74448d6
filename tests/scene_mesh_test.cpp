// Scenes whose meshes stand in them, and meshes that come as bytes: no other file is read.

#include <nuno/scene_file.h>

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include "temporary_folder.h"

namespace nuno {
namespace {

const std::string sheets = NUNO_SCENES "/sheets/";

std::string bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Two triangles, the one upon the other's edge, with these in place of the fields.
std::string scene(const std::string& initial, const std::string& target) {
  return R"({"nuno_scene":1,"arrival_time":1,"initial":)" + initial + R"(,"target":)" + target +
         "}";
}
const std::string vertices = R"("vertices":[[0,0,0],[1,0,0],[1,1,0],[0,1,0]])";
const std::string initial = "{" + vertices + R"(,"faces":[[0,1,2],[0,2,3]]})";
const std::string target = "{" + vertices + "}";

TEST(SceneMesh, ASheetReadsBackToTheLastBit) {
  const auto first = std::get<SheetInput>(read_scene(sheets + "cape-with-a-hole.json"));
  const std::string text = to_json(first);
  const auto again = std::get<SheetInput>(parse_whole_scene(text, "again.json"));
  EXPECT_EQ(again.scene.initial, first.scene.initial);
  EXPECT_EQ(again.scene.target, first.scene.target);
  EXPECT_EQ(again.scene.faces, first.scene.faces);
  EXPECT_GT(again.scene.faces.size(), 200U);
  EXPECT_EQ(again.scene.damping_ratio, first.scene.damping_ratio);
  EXPECT_EQ(to_json(again), text);
}

TEST(SceneMesh, TextureAndTheNumbersOfItsFileStay) {
  SheetInput sheet = std::get<SheetInput>(parse_whole_scene(scene(initial, target), "s"));
  sheet.mesh.texture_coordinates = Points{{0, 1, 1, 0, 0.5}, {0, 0, 1, 1, 0.5}};
  sheet.mesh.texture_corners = {{0, 1, 2}, {4, 2, 3}};
  sheet.mesh.file_vertices = {0, 1, 2, 3, 0};
  const auto again = std::get<SheetInput>(parse_whole_scene(to_json(sheet), "again"));
  EXPECT_EQ(again.mesh.texture_coordinates, sheet.mesh.texture_coordinates);
  EXPECT_EQ(again.mesh.texture_corners, sheet.mesh.texture_corners);
  EXPECT_EQ(again.mesh.file_vertices, sheet.mesh.file_vertices);
}

TEST(SceneMesh, TheCommandLineReadsItAsWell) {
  EXPECT_NO_THROW(parse_any_scene(scene(initial, target), "/nowhere/scene.json"));
}

TEST(SceneMesh, WhatIsWrongIsToldWithItsPlace) {
  const std::vector<std::pair<std::string, std::string>> wrong = {
      {scene("{" + vertices + "}", target), "s: /initial/faces: is missing"},
      {scene(R"({"faces":[[0,1,2]]})", target), "s: /initial/vertices: is missing"},
      {scene("{" + vertices + R"(,"faces":[[0,1,4]]})", target),
       "s: /initial/faces/0: 4 is not a whole number within 0 … 3"},
      {scene("{" + vertices + R"(,"faces":[[0,1,1.5]]})", target), "1.5 is not a whole number"},
      {scene("{" + vertices + R"(,"faces":7})", target), "s: /initial/faces: 7 is not a list"},
      {scene("{" + vertices + R"(,"faces":[[0,1,2],[0,2]]})", target), "2 corners are not 3 or 4"},
      {scene(initial, initial), "s: /target: \"faces\" is not one of vertices"},
      {scene(initial, R"({"vertices":[[0,0],[1,1]]})"),
       "s: /target/vertices/0: 2 numbers are not 3"},
      {scene(initial, R"({"vertices":[[0,0,0],[1,0,0],[1,1,0]]})"), "3 vertices are not the 4"},
      {scene(initial, R"("flag.obj")"), "s: /target: \"flag.obj\" is not a mesh"},
      {scene(R"("flag.obj")", R"("flag.obj")"), "s: /initial: a mesh file is not read here"}};
  for (const auto& [text, message] : wrong) {
    try {
      parse_whole_scene(text, "s");
      FAIL() << "not refused: " << text;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(message), std::string::npos)
          << error.what() << "\nis not: " << message;
    }
  }
}

TEST(SceneMesh, BytesAreReadAsTheirFileIs) {
  const std::string path = sheets + "square-to-s-target.obj";
  const Mesh from_file = read_mesh(path), from_bytes = parse_mesh(bytes_of(path), "s.obj");
  EXPECT_EQ(from_bytes.vertices, from_file.vertices);
  EXPECT_EQ(from_bytes.faces, from_file.faces);
}

TEST(SceneMesh, BytesOfGltfOpenNoFile) {
  // A buffer that is there: from a file it would be read.
  const TemporaryFolder folder;
  const float corners[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  std::ofstream(folder / "hosts", std::ios::binary)
      .write(reinterpret_cast<const char*>(corners), sizeof(corners));
  const std::string gltf =
      R"({"asset":{"version":"2.0"},"buffers":[{"uri":"hosts","byteLength":36}],)"
      R"("bufferViews":[{"buffer":0,"byteLength":36}],)"
      R"("accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],)"
      R"("meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}]})";
  std::ofstream(folder / "mesh.gltf") << gltf;
  EXPECT_EQ(read_mesh(folder / "mesh.gltf").vertices.cols(), 3);
  try {
    parse_mesh(gltf, (folder / "mesh.gltf").string());
    FAIL() << "a file was read";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("is a file of its own"), std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace nuno
