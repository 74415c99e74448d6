// What is wrong with a mesh in glTF is refused at the door, in bounded memory, and no file outside
// the mesh's folder is read.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "mesh_formats.h"

namespace nuno {
namespace {

BadFile bad_gltf(const std::string& name, const std::function<void(Gltf&)>& spoil,
                 const std::string& place, const std::string& value, const std::string& rule) {
  Gltf gltf = square_gltf();
  spoil(gltf);
  return {name, "cloth.gltf", gltf.text(), place, value, rule};
}

BadFile gltf_with(const std::string& name, const std::string& pointer, const Json& value,
                  const std::string& rule, const std::string& place = "") {
  return bad_gltf(
      name, [&](Gltf& gltf) { gltf.json[Json::json_pointer(pointer)] = value; },
      std::string(": ") + (place.empty() ? pointer : place), "", rule);
}

BadFile gltf_without(const std::string& name, const std::string& pointer) {
  return bad_gltf(
      name,
      [&](Gltf& gltf) {
        gltf.json = gltf.json.patch({{{"op", "remove"}, {"path", pointer}}});
      },
      std::string(": ") + pointer, "", "is missing");
}

/// With another place for the buffer.
BadFile gltf_at(const std::string& name, const Json& uri, const std::string& rule) {
  return bad_gltf(
      name,
      [&](Gltf& gltf) {
        gltf.json["buffers"] = {{{"byteLength", gltf.buffer.size()}, {"uri", uri}}};
      },
      ": /buffers/0/uri", "", rule);
}

std::string many_values() {
  std::string all = "[0";
  for (int i = 0; i < 3'000'000; ++i) all += ",0";
  return all + "]";
}

// Its accessors are 0 the positions, 1 the indices, 2 the morph target.
std::vector<BadFile> bad_gltf_documents() {
  const std::string good = square_gltf().text();
  return {
      {"GltfEmpty", "cloth.gltf", "", ": /", "", "not JSON"},
      {"GltfCutOff", "cloth.gltf", good.substr(0, good.size() / 2), ": /", "", "not JSON"},
      {"GltfList", "cloth.gltf", "[]", ": /", "[]", "is not an object"},
      {"GltfDeep", "cloth.gltf", std::string(100'000, '['), ": /", "", "nested more than 64"},
      {"GltfFieldTwice", "cloth.gltf", R"({"asset": {"version": "2.0"}, "asset": {}})", ": /asset",
       "", "stands twice"},
      {"GltfMillionsOfValues", "cloth.gltf", many_values(), ": /", "", "more than 2000000 values"},
      gltf_without("GltfWithoutAsset", "/asset"),
      gltf_with("GltfOfVersionOne", "/asset/version", "1.0", "\"1.0\" is not 2.0"),
      gltf_without("GltfWithoutMeshes", "/meshes"),
      gltf_with("GltfNoMeshes", "/meshes", Json::array(), "is empty"),
      gltf_with("GltfMeshesInWords", "/meshes", "all", "\"all\" is not an array"),
      gltf_with("GltfNoPrimitives", "/meshes/0/primitives", Json::array(), "is empty"),
      gltf_with("GltfPrimitiveIsANumber", "/meshes/0/primitives/0", 7, "7 is not an object"),
      gltf_without("GltfWithoutPositions", "/meshes/0/primitives/0/attributes/POSITION"),
      gltf_with("GltfPositionOutOfRange", "/meshes/0/primitives/0/attributes/POSITION", 99,
                "99 is not a whole number within 0 … 2"),
      gltf_with("GltfModeUnknown", "/meshes/0/primitives/0/mode", 7,
                "7 is not a whole number within 0 … 6"),
      gltf_with("GltfOnlyPoints", "/meshes/0/primitives/0/mode", 0, "has no triangle", "/meshes/0"),
      gltf_with("GltfDraco", "/extensionsRequired", {"KHR_draco_mesh_compression"}, "is not read",
                "/extensionsRequired/0"),
      gltf_with("GltfSkin", "/nodes/0/skin", 0, "bones pose the mesh"),
      gltf_with("GltfNodeBelowItself", "/nodes/0/children", {0}, "is a node below itself",
                "/nodes/0"),
      gltf_with("GltfNodeOfTwoParents", "/nodes",
                Json::parse(R"([{"mesh": 0}, {"children": [0]}, {"children": [0]}])"),
                "0 is a child of node 1 already", "/nodes/2/children/0"),
      gltf_with(
          "GltfCycleOfNodes", "/nodes",
          Json::parse(R"([{"mesh": 0, "children": [1]}, {"children": [2]}, {"children": [0]}])"),
          "is a node below itself", "/nodes/0"),
      gltf_with("GltfChildOutOfRange", "/nodes/0/children", {5},
                "5 is not a whole number within 0 … 0", "/nodes/0/children/0"),
      gltf_with("GltfMatrixOfFifteen", "/nodes/0/matrix", Json(std::vector<int>(15, 1)),
                "15 numbers are not 16"),
      gltf_with("GltfMatrixProjects", "/nodes/0/matrix", Json(std::vector<int>(16, 1)),
                "as its fourth row"),
      gltf_with("GltfScaleInWords", "/nodes/0/scale", {1, "two", 3}, "\"two\" is not a number",
                "/nodes/0/scale/1"),
      gltf_with("GltfRotationOfNothing", "/nodes/0/rotation", {0, 0, 0, 0}, "length 0 is not 1"),
  };
}

std::vector<BadFile> bad_gltf_numbers() {
  const auto sparse = [](std::uint8_t index, const Json& count) {
    return [=](Gltf& gltf) {
      gltf.json["accessors"][0]["sparse"] = {
          {"count", count},
          {"indices",
           {{"bufferView", gltf.view(bytes_of<std::uint8_t>({index}))}, {"componentType", 5121}}},
          {"values", {{"bufferView", gltf.view(bytes_of<float>({1, 2, 3}))}}}};
    };
  };
  const auto floats = [](float value) {
    return [=](Gltf& gltf) {
      gltf.primitive()["attributes"]["POSITION"] =
          gltf.add_floats({0, 0, 0, 1, 0, 0, 0, value, 1, 1, 0, 1});
    };
  };
  return {
      gltf_with("GltfCountHuge", "/accessors/0/count", 4294967296,
                "4294967296 is not a whole number within 1 … 6000000"),
      gltf_with("GltfCountNegative", "/accessors/0/count", -1, "-1 is not a whole number"),
      gltf_with("GltfCountInWords", "/accessors/0/count", "4", "\"4\" is not a whole number"),
      gltf_with("GltfCountBeyondItsView", "/accessors/0/count", 5,
                "5 elements end at byte 60, not within the 48", "/accessors/0"),
      bad_gltf(
          "GltfHugeCountOfNothing",
          [](Gltf& g) {
            g.json["accessors"][0] = {{"componentType", 5126}, {"type", "VEC3"}, {"count", 1e18}};
          },
          ": /accessors/0/count", "1e+18", "is not a whole number"),
      gltf_with("GltfOffsetBeyondItsView", "/accessors/0/byteOffset", 4000000000,
                "not within the 48", "/accessors/0"),
      gltf_with("GltfPositionsOfTwo", "/accessors/0/type", "VEC2", "\"VEC2\" is not \"VEC3\""),
      gltf_with("GltfTypeIsANumber", "/accessors/0/type", 3, "3 is not a string"),
      gltf_with("GltfUnknownComponent", "/accessors/0/componentType", 5130, "5130 is not 5120"),
      gltf_with("GltfIndicesOfFloats", "/accessors/1/componentType", 5126, "5126 is not 5121"),
      gltf_with("GltfViewOutOfRange", "/accessors/0/bufferView", 9,
                "9 is not a whole number within 0 … 2"),
      gltf_with("GltfViewBeyondItsBuffer", "/bufferViews/0/byteLength", 1000000,
                "is not within the buffer's"),
      gltf_with("GltfViewStartsBeyondItsBuffer", "/bufferViews/0/byteOffset", 1099511627776,
                "is not within the buffer's", "/bufferViews/0/byteLength"),
      gltf_with("GltfStrideBelowItsElements", "/bufferViews/0/byteStride", 4,
                "4 is not a whole number within 12 … 252"),
      bad_gltf(
          "GltfIndexOutOfRange",
          [](Gltf& g) {
            g.primitive()["indices"] = g.add<std::uint16_t>({0, 2, 4}, 5123, "SCALAR");
          },
          ": /meshes/0/primitives/0/indices", "4", "not among the 4"),
      bad_gltf(
          "GltfFourCorners",
          [](Gltf& g) {
            g.primitive()["indices"] = g.add<std::uint16_t>({0, 2, 1, 3}, 5123, "SCALAR");
          },
          ": /meshes/0/primitives/0", "4", "corners are not those of triangles"),
      bad_gltf("GltfNan", floats(std::nanf("")), ": /accessors/3", "nan, in element 2",
               "is not within ±1000000000000"),
      bad_gltf("GltfInfinite", floats(-INFINITY), ": /accessors/3", "-inf, in element 2",
               "is not within"),
      bad_gltf("GltfSparseOutOfRange", sparse(4, 1), ": /accessors/0/sparse/indices", "4",
               "is not within 0 … 3"),
      bad_gltf("GltfSparseTooMany", sparse(1, 5), ": /accessors/0/sparse/count", "5",
               "within 1 … 4"),
      bad_gltf("GltfSparseBeyondItsView", sparse(1, 2), ": /accessors/0/sparse/indices",
               "2 elements end at byte 2", "not within the 1"),
      bad_gltf(
          "GltfTextureOfOneVertex",
          [](Gltf& g) {
            g.primitive()["attributes"]["TEXCOORD_0"] = g.add_floats({0, 0}, "VEC2");
          },
          ": /meshes/0/primitives/0/attributes/TEXCOORD_0", "1 elements", "each of the 4 vertices"),
  };
}

std::vector<BadFile> bad_gltf_buffers() {
  const std::string glb = square_gltf().binary();
  const auto glb_with = [&](std::size_t at, std::uint32_t word) {
    return std::string(glb).replace(at, 4, bytes_of<std::uint32_t>({word}));
  };
  return {
      gltf_at("GltfBufferAbove", "../secret.bin", "is not a file in the folder of the mesh"),
      gltf_at("GltfBufferAboveInDisguise", "inner/%2e%2e/%2E%2E/secret.bin",
              "is not a file in the folder of the mesh"),
      gltf_at("GltfBufferAtTheRoot", "/etc/passwd", "is not a file in the folder of the mesh"),
      gltf_at("GltfBufferAtAFileUrl", "file:///etc/passwd",
              "is not a file in the folder of the mesh"),
      gltf_at("GltfBufferOnTheNet", "https://example.com/a.bin",
              "is not a file in the folder of the mesh"),
      gltf_at("GltfBufferBehindALink", "link.bin", "is not a file in the folder of the mesh"),
      gltf_at("GltfBufferWithANul", "a%00.bin", "is not a file in the folder of the mesh"),
      gltf_at("GltfBufferIsAFolder", "inner", "is not there, or no file"),
      gltf_at("GltfBufferIsAPipe", "pipe.bin", "is not there, or no file"),
      gltf_at("GltfBufferIsNotThere", "no.bin", "\"no.bin\" is not there, or no file"),
      gltf_at("GltfBufferIsANumber", 7, "7 is not a string"),
      gltf_at("GltfDataInPercents", "data:,abc", "is not a data URI in base64"),
      gltf_at("GltfDataNotBase64", "data:;base64,AA?A", "?A\" is not base64"),
      bad_gltf(
          "GltfDataTooShort",
          [](Gltf& g) {
            g.json["buffers"] = {{{"byteLength", 108}, {"uri", "data:;base64,AAAA"}}};
          },
          ": /buffers/0/byteLength", "108", "is not <= 3, the bytes that are there"),
      bad_gltf(
          "GltfDataLikeABomb",
          [](Gltf& g) {
            g.json["buffers"] = {
                {{"byteLength", 4e9}, {"uri", "data:application/gzip;base64,H4sIAAAAAAAA"}}};
          },
          ": /buffers/0/byteLength", "4000000000", "the bytes that are there"),
      bad_gltf(
          "GltfDataOfManyBytes",
          [](Gltf& g) {
            g.json["buffers"] = {
                {{"byteLength", 4e9},
                 {"uri", std::string("data:;base64,") + std::string(60 << 20, 'A')}}};
          },
          ": /buffers/0/byteLength", "4000000000", "is not <= 47185920"),
      bad_gltf(
          "GltfBufferWithoutUri",
          [](Gltf& g) {
            g.json["buffers"] = {{{"byteLength", 108}}};
          },
          ": /buffers/0", "", "has no uri"),
      {"GlbCutOff", "cloth.glb", glb.substr(0, glb.size() - 8), ": byte 8", "",
       "is not the file's"},
      {"GlbHeadAlone", "cloth.glb", "glTF", ": byte 4", "", "ends within the head"},
      {"GlbOfVersionOne", "cloth.glb", glb_with(4, 1), ": byte 4", "version 1", "is not 2"},
      {"GlbChunkTooLong", "cloth.glb", glb_with(12, 0xfffffff0), ": byte 12", "4294967280",
       "is not within"},
      {"GlbWithoutJson", "cloth.glb", glb_with(16, 0x004E4942), ": byte 16", "",
       "the first chunk is not JSON"},
      {"MeshOfAnotherKind", "cloth.fbx", "Kaydara", "", "",
       "does not end in .obj, .ply, .gltf or .glb"},
  };
}

std::vector<BadFile> bad_gltfs() {
  std::vector<BadFile> all;
  for (const auto& some : {bad_gltf_documents(), bad_gltf_numbers(), bad_gltf_buffers()}) {
    all.insert(all.end(), some.begin(), some.end());
  }
  return all;
}

TEST_P(MalformedMeshFormat, IsRefusedInOneLineThatSaysWhereAndWhy) { expect_refused(GetParam()); }

INSTANTIATE_TEST_SUITE_P(EachOf, MalformedMeshFormat, testing::ValuesIn(bad_gltfs()),
                         [](const auto& bad) { return bad.param.name; });

}  // namespace
}  // namespace nuno
