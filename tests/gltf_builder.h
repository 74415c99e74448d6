#pragma once

#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace nuno {

/// Bytes of numbers, little-endian as the machine.
template <typename Number>
std::string bytes_of(const std::vector<Number>& numbers) {
  std::string bytes(numbers.size() * sizeof(Number), '\0');
  if (!numbers.empty()) std::memcpy(bytes.data(), numbers.data(), bytes.size());
  return bytes;
}

inline std::string base64(std::string_view bytes) {
  constexpr std::string_view digits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t bits = 0;
    for (std::size_t k = i; k < i + 3; ++k) {
      bits = bits << 8 | (k < bytes.size() ? static_cast<unsigned char>(bytes[k]) : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      text += i + k > bytes.size() ? '=' : digits[bits >> (18 - 6 * k) & 63];
    }
  }
  return text;
}

/// A glTF file made by hand: what is added to `json` is the file's, and its numbers are in one
/// buffer.
struct Gltf {
  nlohmann::json json = nlohmann::json::parse(
      R"({"asset": {"version": "2.0"}, "meshes": [{"primitives": [{"attributes": {}}]}]})");
  std::string buffer;

  nlohmann::json& primitive(std::size_t number = 0) {
    return json["meshes"][0]["primitives"][number];
  }

  /// Adds a view of these bytes, and returns its number.
  std::size_t view(const std::string& bytes) {
    json["bufferViews"].push_back(
        {{"buffer", 0}, {"byteOffset", buffer.size()}, {"byteLength", bytes.size()}});
    buffer += bytes;
    buffer.resize((buffer.size() + 3) / 4 * 4);
    return json["bufferViews"].size() - 1;
  }

  /// Adds an accessor and returns its number.
  std::size_t accessor(const nlohmann::json& fields) {
    json["accessors"].push_back(fields);
    return json["accessors"].size() - 1;
  }
  template <typename Number>
  std::size_t add(const std::vector<Number>& numbers, int component_type, const std::string& type) {
    const std::size_t each = type == "VEC3" ? 3 : type == "VEC2" ? 2 : 1;
    return accessor({{"bufferView", view(bytes_of(numbers))},
                     {"componentType", component_type},
                     {"type", type},
                     {"count", numbers.size() / each}});
  }
  std::size_t add_floats(const std::vector<float>& numbers, const std::string& type = "VEC3") {
    return add(numbers, 5126, type);
  }

  /// As text, with the buffer as a data URI.
  std::string text() const {
    nlohmann::json all = json;
    if (!all.contains("buffers")) {
      all["buffers"] = {
          {{"byteLength", buffer.size()},
           {"uri", std::string("data:application/octet-stream;base64,") + base64(buffer)}}};
    }
    return all.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  }

  /// As binary glTF.
  std::string binary() const {
    nlohmann::json all = json;
    all["buffers"] = {{{"byteLength", buffer.size()}}};
    std::string head = all.dump();
    head.resize((head.size() + 3) / 4 * 4, ' ');
    const auto size = [](std::size_t n) { return static_cast<std::uint32_t>(n); };
    return "glTF" +
           bytes_of<std::uint32_t>(
               {2, size(28 + head.size() + buffer.size()), size(head.size()), 0x4E4F534A}) +
           head + bytes_of<std::uint32_t>({size(buffer.size()), 0x004E4942}) + buffer;
  }
};

/// Four corners of a unit square and two triangles, with a morph target "up" a metre above.
inline Gltf square_gltf() {
  Gltf gltf;
  gltf.primitive()["attributes"]["POSITION"] =
      gltf.add_floats({0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 1});
  gltf.primitive()["indices"] = gltf.add<std::uint16_t>({0, 2, 1, 1, 2, 3}, 5123, "SCALAR");
  gltf.primitive()["targets"] = {
      {{"POSITION", gltf.add_floats({0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0})}}};
  gltf.json["meshes"][0]["extras"] = {{"targetNames", {"up"}}};
  gltf.json["nodes"] = {{{"mesh", 0}}};
  return gltf;
}

}  // namespace nuno
