// What is wrong with a mesh in PLY or glTF is refused at the door, in bounded memory, and no file
// outside the mesh's folder is read.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <sys/resource.h>
#include <sys/stat.h>

#include "gltf_builder.h"
#include "program.h"

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool is_sanitized = true;
#else
constexpr bool is_sanitized = false;
#endif

namespace nuno {
namespace {

struct BadFile {
  std::string name;
  std::string file;  ///< its name
  std::string content;
  std::string place;  ///< that the message names, after the file
  std::string value;  ///< that it shows
  std::string rule;   ///< that it says was broken
};

void PrintTo(const BadFile& bad, std::ostream* out) { *out << bad.name; }

// PLY

const std::string ply_head = "ply\nformat ascii 1.0\n";
const std::string ply_vertices =
    "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n";
const std::string ply_faces =
    "element face 2\nproperty list uchar int vertex_indices\nend_header\n";
const std::string ply_body = "0 0 0\n1 0 0\n0 0 1\n1 0 1\n3 0 2 1\n3 1 2 3\n";
const std::string ply = ply_head + ply_vertices + ply_faces + ply_body;

std::string replaced(std::string text, const std::string& old, const std::string& fresh) {
  return text.replace(text.find(old), old.size(), fresh);
}

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

// glTF

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
      {"GltfFieldTwice", "cloth.gltf", R"({"asset": {"version": "2.0"}, "asset": {}})", ": /",
       "asset", "twice"},
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

std::vector<BadFile> bad_files() {
  std::vector<BadFile> all;
  for (const auto& some :
       {bad_plys(), bad_gltf_documents(), bad_gltf_numbers(), bad_gltf_buffers()}) {
    all.insert(all.end(), some.begin(), some.end());
  }
  return all;
}

/// A folder within another, in which a secret is; a program that may take 1 GiB.
class MeshFormats : public Program {
 protected:
  MeshFormats() {
    const std::string secret = square_gltf().buffer;
    fs::create_directories(in_folder("shot/inner"));
    write_text(in_folder("secret.bin"), secret);
    fs::create_symlink(in_folder("secret.bin"), in_folder("shot/link.bin"));
    mkfifo(in_folder("shot/pipe.bin").c_str(), 0600);
    getrlimit(RLIMIT_AS, &limit_);
    if (is_sanitized) return;  // sanitizers take address space, not memory
    rlimit one_gib = limit_;
    one_gib.rlim_cur = 1 << 30;
    setrlimit(RLIMIT_AS, &one_gib);
  }
  ~MeshFormats() override { setrlimit(RLIMIT_AS, &limit_); }

  std::string in_shot(const std::string& name) const { return in_folder("shot/" + name); }

  Outcome thrown(const std::string& start, const std::string& target) const {
    return nuno({"throw", start, target, "--time", "1", "--out", output("flight.glb")});
  }

 private:
  rlimit limit_{};
};

class MalformedMeshFormat : public MeshFormats, public testing::WithParamInterface<BadFile> {};

TEST_P(MalformedMeshFormat, IsRefusedInOneLineThatSaysWhereAndWhy) {
  const BadFile& bad = GetParam();
  const std::string path = in_shot(bad.file);
  write_text(path, bad.content);
  const Outcome run = thrown(path, path);
  EXPECT_EQ(run.status, 2) << run.err;
  EXPECT_EQ(run.out, "");
  EXPECT_TRUE(is_one_line(run.err)) << run.err;
  EXPECT_TRUE(run.err.starts_with(path + bad.place + ": ")) << run.err << "not at " << bad.place;
  EXPECT_NE(run.err.find(bad.value), std::string::npos) << run.err;
  EXPECT_NE(run.err.find(bad.rule), std::string::npos) << run.err;
  EXPECT_LT(run.err.size(), 500u) << "a line that a person can read";
  for (const char c : run.err.substr(0, run.err.size() - 1)) {
    EXPECT_GE(static_cast<unsigned char>(c), ' ') << "no code for a terminal";
  }
  EXPECT_TRUE(outputs().empty());
}

INSTANTIATE_TEST_SUITE_P(EachOf, MalformedMeshFormat, testing::ValuesIn(bad_files()),
                         [](const auto& bad) { return bad.param.name; });

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
