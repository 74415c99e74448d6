// What is wrong with a mesh in PLY is refused at the door, in bounded memory.

#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

#include "mesh_formats.h"

namespace nuno {
namespace {

BadFile bad_ply(const std::string& name, const std::string& content, const std::string& place,
                const std::string& value, const std::string& rule) {
  return {name, "cloth.ply", content, place, value, rule};
}
BadFile ply_with(const std::string& name, const std::string& old, const std::string& fresh,
                 const std::string& place, const std::string& value, const std::string& rule) {
  return bad_ply(name, replaced(ply, old, fresh), place, value, rule);
}

std::vector<BadFile> bad_plys() {
  const std::string binary =
      replaced(ply_head, "ascii", "binary_little_endian") + ply_vertices + ply_faces;
  const std::string corners = bytes_of<float>({0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 1});
  const auto face = [](std::int32_t a, std::int32_t b, std::int32_t c) {
    return std::string("\3") + bytes_of<std::int32_t>({a, b, c});
  };
  return {
      bad_ply("PlyEmpty", "", "", "the first line", "is not \"ply\""),
      bad_ply("PlyOfObj", "v 0 0 0\n", ":1", "the first line", "is not \"ply\""),
      bad_ply("PlyHeaderCutOff", ply_head + ply_vertices, ":6", "the header",
              "has no \"end_header\""),
      ply_with("PlyFormatOfTheFuture", "ascii 1.0", "ascii 2.0", ":2", "format ascii 2.0",
               "is not \"format"),
      ply_with("PlyWithoutFormat", "format ascii 1.0\n", "", ":8", "end_header",
               "before any \"format\""),
      ply_with("PlyUnknownStatement", "element face", "elements face", ":7", "elements",
               "is not a statement"),
      ply_with("PlyUnknownType", "float y", "half y", ":5", "half", "is not a type"),
      ply_with("PlyCountInFloats", "list uchar", "list float", ":8", "float", "does not count"),
      ply_with("PlyPropertyWithoutName", "float y", "float", ":5", "property float",
               "is not \"property"),
      ply_with("PlyPropertyOfNothing", "element vertex 4\n", "", ":3", "property float x",
               "before any element"),
      ply_with("PlyCountNegative", "vertex 4", "vertex -4", ":3", "element vertex -4",
               "is not \"element NAME COUNT\""),
      ply_with("PlyCountHuge", "vertex 4", "vertex 4000000000", ":3", "4000000000",
               "are not <= 6000000"),
      ply_with("PlyCountBeyondIntegers", "face 2", "face 99999999999999999999", ":7",
               "99999999999999999999", "is not"),
      ply_with("PlyElementTwice", "element face 2", "element vertex 2", ":7", "vertex",
               "stands twice"),
      ply_with("PlyWithoutZ", "float z", "float w", "", "the element vertex",
               "has not the property z"),
      ply_with("PlyWithoutCorners", "vertex_indices", "corners", "", "the element face",
               "has not a list vertex_indices"),
      ply_with("PlyCoordinateNan", "\n1 0 0", "\n1 nan 0", ":11", "nan", "is not a number"),
      ply_with("PlyCoordinateBeyondCloth", "\n1 0 0", "\n1 1e300 0", ":11", "1e+300",
               "is not within ±1000000000000"),
      ply_with("PlyCoordinateInWords", "\n1 0 0", "\n1 one 0", ":11", "one", "is not a number"),
      ply_with("PlyCoordinateMissing", "\n1 0 0", "\n1 0", ":11", "1 0", "has fewer values"),
      ply_with("PlyCoordinateTooMany", "\n1 0 0", "\n1 0 0 7", ":11", "7", "is one value more"),
      ply_with("PlyTwoCorners", "3 1 2 3", "2 1 2", ":15", "2", "corners are not within 3 … 1000"),
      ply_with("PlyHugeFace", "3 1 2 3", "255 1 2 3", ":15", "255 1 2 3", "has fewer values"),
      ply_with("PlyVertexThatIsNotThere", "3 1 2 3", "3 1 2 4", ":15", "4", "not among the 4"),
      ply_with("PlyVertexNegative", "3 1 2 3", "3 1 2 -1", ":15", "-1", "not among the 4"),
      ply_with("PlyVertexOfHalves", "3 1 2 3", "3 1 2.5 3", ":15", "2.5",
               "is not a number of type int32"),
      ply_with("PlyVertexTwice", "3 1 2 3", "3 1 2 2", ":15", "2", "stands twice in the face"),
      ply_with("PlyMoreFacesThanSaid", "face 2", "face 1", "", "", "goes on after the elements"),
      ply_with("PlyFewerFacesThanSaid", "face 2", "face 3", ": face 2", "the element",
               "is not there"),
      bad_ply("PlyOfPoints", ply_head + ply_vertices + "end_header\n0 0 0\n1 0 0\n0 0 1\n1 0 1\n",
              "", "", "has no face"),
      bad_ply("PlyBinaryCutOff", binary + corners + face(0, 2, 1) + "\3\1", ": face 1",
              "the element", "the file ends before"),
      bad_ply("PlyBinaryVertexThatIsNotThere",
              binary + corners + face(0, 2, 1) + face(1, 2, 1 << 30), ": face 1", "1073741824",
              "not among the 4"),
      bad_ply("PlyBinaryNan",
              binary + bytes_of<float>({std::nanf(""), 0, 0}) + corners.substr(12) + face(0, 2, 1) +
                  face(1, 2, 3),
              ": vertex 0", "nan", "is not within"),
      bad_ply("PlyBinaryHugeList",
              replaced(replaced(binary, "face 2", "face 1"), "uchar int", "uint int") + corners +
                  "\xff\xff\xff\xff",
              ": face 0", "4294967295", "corners are not within 3"),
      bad_ply(
          "PlyBinaryHugeListPassedOver",
          replaced(binary, "vertex_indices\n", "vertex_indices\nproperty list uint double d\n") +
              corners + face(0, 2, 1) + "\xff\xff\xff\xff",
          ": face 0", "the element", "the file ends before"),
      bad_ply("PlyTerminalCodes", ply_head + "\x1b[2J\n", ":3", "[2J", "is not a statement"),
  };
}

TEST_P(MalformedMeshFormat, IsRefusedInOneLineThatSaysWhereAndWhy) { expect_refused(GetParam()); }

INSTANTIATE_TEST_SUITE_P(EachOf, MalformedMeshFormat, testing::ValuesIn(bad_plys()),
                         [](const auto& bad) { return bad.param.name; });

}  // namespace
}  // namespace nuno
