#pragma once

// Binary glTF read back by the letter of its specification, as far as write_glb uses it.

#include <nuno/points.h>

#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace nuno {

class GlbFile {
 public:
  explicit GlbFile(std::string bytes) : bytes_(std::move(bytes)) {
    EXPECT_EQ(bytes_.substr(0, 4), "glTF");
    EXPECT_EQ(word(4), 2u);
    EXPECT_EQ(word(8), bytes_.size());
    const std::size_t length = word(12);
    EXPECT_EQ(bytes_.substr(16, 4), "JSON");
    EXPECT_EQ(length % 4, 0u);
    json = nlohmann::json::parse(bytes_.substr(20, length));
    const std::size_t chunk = 20 + length;
    EXPECT_EQ(bytes_.substr(chunk + 4, 4), std::string("BIN\0", 4));
    data_ = chunk + 8;
    EXPECT_EQ(data_ + word(chunk), bytes_.size());
    EXPECT_EQ(json["buffers"][0]["byteLength"], word(chunk));
  }

  /// The numbers of an accessor, a column each: floats, or indices.
  Points read(std::size_t accessor) const {
    const auto& of = json["accessors"][accessor];
    const auto& view = json["bufferViews"][of["bufferView"].get<std::size_t>()];
    const std::string type = of["type"];
    const Index rows = type == "SCALAR" ? 1 : type == "VEC2" ? 2 : 3;
    Points result(rows, of["count"].get<Index>());
    const std::size_t start = data_ + view["byteOffset"].get<std::size_t>();
    const std::size_t size = static_cast<std::size_t>(result.size()) * 4;
    EXPECT_EQ(view["byteLength"], size);
    EXPECT_EQ(start % 4, 0u);
    EXPECT_LE(start + size, bytes_.size());
    for (Index i = 0; i < result.size(); ++i) {
      const std::uint32_t bits = word(start + 4 * static_cast<std::size_t>(i));
      float value = 0;
      std::memcpy(&value, &bits, 4);
      result.data()[i] = of["componentType"] == 5125 ? bits : static_cast<double>(value);
    }
    for (Index row = 0; row < rows && of.contains("min"); ++row) {
      EXPECT_EQ(of["min"][static_cast<std::size_t>(row)], result.row(row).minCoeff());
      EXPECT_EQ(of["max"][static_cast<std::size_t>(row)], result.row(row).maxCoeff());
    }
    return result;
  }

  const nlohmann::json& primitive() const { return json["meshes"][0]["primitives"][0]; }

  /// An attribute ("POSITION", …) at frame k, as a player adds it up.
  Points at_frame(const char* attribute, std::size_t k) const {
    const Points base = read(primitive()["attributes"][attribute]);
    return k == 0 ? base : base + read(primitive()["targets"][k - 1][attribute]);
  }
  std::size_t frames() const {
    return 1 + (primitive().contains("targets") ? primitive()["targets"].size() : 0);
  }
  Points indices() const { return read(primitive()["indices"]); }

  /// Of the animation's only sampler: "input" (times) or "output" (weights).
  Points sampler(const char* side) const {
    return read(json["animations"][0]["samplers"][0][side]);
  }

  nlohmann::json json;

 private:
  std::uint32_t word(std::size_t at) const {
    std::uint32_t value = 0;
    std::memcpy(&value, bytes_.data() + at, 4);
    return value;
  }

  std::string bytes_;
  std::size_t data_ = 0;
};

}  // namespace nuno
