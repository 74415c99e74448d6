// Both point caches hold nothing but a head and every frame's vertices, as floats.
#include <bit>
#include <cstdint>
#include <vector>

#include "animation_files.h"

namespace nuno {
namespace {

/// Numbers of 4 bytes, in the byte order that a format asks for.
class Writer {
 public:
  Writer(std::FILE* file, std::endian order) : file_(file), turned_(order != std::endian::native) {}

  void write(std::int32_t value) { write_word(std::bit_cast<std::uint32_t>(value)); }
  void write(float value) { write_word(std::bit_cast<std::uint32_t>(value)); }

  void write(const Points& shape) {
    for (const double x : shape.reshaped()) write(static_cast<float>(x));
  }

 private:
  void write_word(std::uint32_t word) {
    if (turned_) {
      word = word >> 24 | (word >> 8 & 0xff00) | (word << 8 & 0xff0000) | word << 24;
    }
    std::fwrite(&word, sizeof word, 1, file_);
  }

  std::FILE* file_;
  bool turned_;
};

std::int32_t vertices(const Animation& animation) {
  return static_cast<std::int32_t>(animation.positions.front().cols());
}

std::int32_t frames(const Animation& animation) {
  return static_cast<std::int32_t>(animation.positions.size());
}

}  // namespace

void write_pc2(std::FILE* file, const Animation& animation) {
  constexpr char signature[12] = "POINTCACHE2";
  constexpr std::int32_t version = 1;
  constexpr float frames_per_sample = 1;
  std::fwrite(signature, sizeof signature, 1, file);
  Writer writer(file, std::endian::little);
  writer.write(version);
  writer.write(vertices(animation));
  writer.write(static_cast<float>(animation.first_frame));
  writer.write(frames_per_sample);
  writer.write(frames(animation));
  for (const Points& shape : animation.positions) writer.write(shape);
}

void write_mdd(std::FILE* file, const Animation& animation) {
  Writer writer(file, std::endian::big);
  writer.write(frames(animation));
  writer.write(vertices(animation));
  for (const double time : animation.times) writer.write(static_cast<float>(time));
  for (const Points& shape : animation.positions) writer.write(shape);
}

}  // namespace nuno
