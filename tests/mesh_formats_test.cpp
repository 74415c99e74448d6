// Meshes of every format fly, alone and onto one another.

#include <gtest/gtest.h>

#include <string>

#include "mesh_formats.h"

namespace nuno {
namespace {

TEST_F(MeshFormats, OfEveryKindAreThrownOntoOneAnother) {
  const Gltf gltf = square_gltf();
  write_text(in_shot("cloth.gltf"), gltf.text());
  write_text(in_shot("cloth.glb"), gltf.binary());
  write_text(in_shot("cloth.ply"), ply);
  write_text(in_shot("cloth.obj"), "v 0 0 0\nv 1 0 0\nv 0 0 1\nv 1 0 1\nf 1 3 2\nf 2 3 4\n");
  for (const char* start : {"cloth.gltf", "cloth.glb", "cloth.ply", "cloth.obj"}) {
    for (const char* target : {"cloth.gltf#up", "cloth.glb#", "cloth.ply", "cloth.obj"}) {
      const Outcome run = thrown(in_shot(start), in_shot(target));
      EXPECT_EQ(run.status, 0) << start << " to " << target << ": " << run.err;
    }
  }
}

TEST_F(MeshFormats, OfOneFileAreThrownToItsOnlyMorphTarget) {
  const std::string path = in_shot("cloth.glb");
  write_text(path, square_gltf().binary());
  const Outcome run = nuno({"throw", path, "--time", "1", "--out", output("flight.json")});
  ASSERT_EQ(run.status, 0) << run.err;
  for (const auto& vertex : read_json(output("flight.json"))["target"]) EXPECT_EQ(vertex[1], 1);
  write_text(in_shot("cloth.ply"), ply);
  const Outcome without = nuno({"throw", in_shot("cloth.ply"), "--time", "1"});
  EXPECT_EQ(without.status, 2);
  EXPECT_TRUE(without.err.starts_with("TARGET: is missing")) << without.err;
  const Outcome unknown = nuno({"throw", path, path + "#down", "--time", "1"});
  EXPECT_EQ(unknown.status, 2);
  EXPECT_EQ(unknown.err, path + ": /meshes/0: \"down\" is not one of its morph targets: up\n");
}

TEST_F(MeshFormats, WithVerticesInAnotherOrderAreNotFlown) {
  write_text(in_shot("start.ply"), ply);
  write_text(in_shot("target.ply"), replaced(ply, "3 1 2 3", "3 0 2 3"));
  const Outcome run = thrown(in_shot("start.ply"), in_shot("target.ply"));
  EXPECT_EQ(run.status, 2);
  EXPECT_EQ(run.err,
            in_shot("target.ply") + ":15: the face 0 2 3 is 1 2 3 in " + in_shot("start.ply") +
                ": the vertices stand in another order, or it is no pose of the same mesh; "
                "export both with the order of vertices kept\n");
}

TEST_F(MeshFormats, SayThatTheyWereWelded) {
  Gltf gltf = square_gltf();
  Json second = gltf.primitive();
  second["attributes"]["POSITION"] = gltf.add_floats({1, 0, 0, 2, 0, 0, 1, 0, 1, 2, 0, 1});
  gltf.json["meshes"][0]["primitives"].push_back(second);
  const std::string path = in_shot("cloth.glb");
  write_text(path, gltf.binary());
  const Outcome run = nuno({"throw", path, "--time", "1"});
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_NE(run.out.find("6 particles"), std::string::npos) << run.out;
  EXPECT_NE(run.out.find("2 of the file's 8 vertices are copies at seams"), std::string::npos)
      << run.out;
}

}  // namespace
}  // namespace nuno
