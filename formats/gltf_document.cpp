#include "gltf_document.h"

#include <nuno/input.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>

#include "compact_json.h"
#include "text_file.h"

namespace nuno {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::size_t largest_json = 64 << 20;      // bytes
constexpr std::size_t largest_buffers = 256 << 20;  // bytes, all together
const JsonForm gltf_form = {.deepest = 64, .most_values = 2'000'000};

// Numbers of the container.
constexpr std::string_view magic = "glTF";
constexpr std::uint32_t json_chunk = 0x4E4F534A, binary_chunk = 0x004E4942;

std::uint32_t word(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  std::memcpy(&value, bytes.data() + at, sizeof value);  // little-endian, as we are
  return value;
}

std::string bytes_of(std::string_view base64, const Field& at) {
  std::string bytes;
  const std::size_t end = from_base64(base64, bytes);
  if (end < base64.size()) {
    at.refuse(fmt::format("{} is not base64", shown(Json(std::string(base64.substr(end, 20))))));
  }
  return bytes;
}

std::string without_percents(const std::string& uri) {
  std::string result;
  const auto digit = [](char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    return c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
  };
  for (std::size_t i = 0; i < uri.size(); ++i) {
    if (uri[i] == '%' && i + 2 < uri.size() && digit(uri[i + 1]) >= 0 && digit(uri[i + 2]) >= 0) {
      result.push_back(static_cast<char>(digit(uri[i + 1]) * 16 + digit(uri[i + 2])));
      i += 2;
    } else {
      result.push_back(uri[i]);
    }
  }
  return result;
}

/// The file that a URI names, in the folder of the mesh or below it, links followed; empty if it is
/// none.
fs::path file_inside(const fs::path& mesh, const std::string& uri) {
  const std::string name = without_percents(uri);
  const std::size_t colon = name.find(':');
  if (name.empty() || name.find('\0') != std::string::npos || name.starts_with('/') ||
      (colon != std::string::npos && colon < name.find('/'))) {
    return {};
  }
  std::error_code error;
  const fs::path folder = fs::canonical(mesh.parent_path() / ".", error);
  if (error) return {};
  const fs::path file = fs::weakly_canonical(folder / name, error);
  if (error) return {};
  const auto [end_of_folder, rest] =
      std::mismatch(folder.begin(), folder.end(), file.begin(), file.end());
  return end_of_folder == folder.end() && rest != file.end() ? file : fs::path();
}

}  // namespace

bool GltfItem::has(const char* name) const {
  if (!value.is_object()) at.refuse(fmt::format("{} is not an object", shown(value)));
  return value.contains(name);
}

GltfItem GltfItem::child(const char* name) const {
  if (!has(name)) at.child(name).refuse("is missing; it is required");
  return {value[name], at.child(name)};
}

GltfItem GltfItem::child(std::size_t number) const {
  return {value[number], at.child(std::to_string(number))};
}

std::size_t GltfItem::size() const {
  if (!value.is_array()) at.refuse(fmt::format("{} is not an array", shown(value)));
  return value.size();
}

Index GltfItem::whole(Index least, Index most) const {
  const double number = value.is_number() ? value.get<double>() : std::nan("");
  if (!(number >= static_cast<double>(least) && number <= static_cast<double>(most) &&
        number == std::floor(number))) {
    at.refuse(fmt::format("{} is not a whole number within {} … {}", shown(value), least, most));
  }
  return static_cast<Index>(number);
}

Index GltfItem::whole(const char* name, Index otherwise, Index least, Index most) const {
  return has(name) ? child(name).whole(least, most) : otherwise;
}

double GltfItem::number() const {
  if (!value.is_number() || !(std::abs(value.get<double>()) <= largest_scene_number)) {
    at.refuse(fmt::format("{} is not a number within ±{}", shown(value), largest_scene_number));
  }
  return value.get<double>();
}

const std::string& GltfItem::text() const {
  if (!value.is_string()) at.refuse(fmt::format("{} is not a string", shown(value)));
  return value.get_ref<const std::string&>();
}

GltfDocument::GltfDocument(const std::string& path)
    : path_(path), text_(read_file(path, path, "a mesh", largest_file)) {
  parse();
}

GltfDocument::GltfDocument(std::string bytes, const std::string& path)
    : path_(path), text_(std::move(bytes)), reads_files_(false) {
  parse();
}

void GltfDocument::parse() {
  if (text_.starts_with(magic)) {
    split_container();
  } else {
    if (text_.size() > largest_json) {
      root().at.refuse(fmt::format("is larger than {} MiB of JSON", largest_json >> 20));
    }
    json_ = parse_compact(text_, path_, gltf_form);
    text_ = {};
  }
  const GltfItem version = root().child("asset").child("version");
  if (!version.text().starts_with("2.")) {
    version.at.refuse(fmt::format("{} is not 2.0", shown(version.value)));
  }
}

/// Of binary glTF: a head of 12 bytes, then chunks of a length, a type and their bytes.
void GltfDocument::split_container() {
  const auto refuse = [&](std::size_t at, const std::string& what) {
    throw InputError(fmt::format("{}: byte {}: {}", path_, at, what));
  };
  const std::string_view all = text_;
  if (all.size() < 20) refuse(all.size(), "ends within the head of binary glTF");
  if (word(all, 4) != 2) refuse(4, fmt::format("version {} is not 2", word(all, 4)));
  if (word(all, 8) != all.size()) {
    refuse(8, fmt::format("length {} is not the file's {} bytes", word(all, 8), all.size()));
  }
  for (std::size_t at = 12; at < all.size();) {
    if (all.size() - at < 8) refuse(at, "ends within the head of a chunk");
    const std::size_t length = word(all, at), start = at + 8;
    if (length > all.size() - start) {
      refuse(at, fmt::format("chunk of {} bytes is not within the {} that are there", length,
                             all.size() - start));
    }
    const std::uint32_t type = word(all, at + 4);
    if (at == 12) {
      if (type != json_chunk) refuse(at + 4, "the first chunk is not JSON");
      if (length > largest_json) {
        refuse(at, fmt::format("is larger than {} MiB of JSON", largest_json >> 20));
      }
      json_ = parse_compact(all.substr(start, length), path_, gltf_form);
    } else if (type == binary_chunk && !binary_) {
      binary_ = all.substr(start, length);
    }
    at = start + length;
  }
}

GltfItem GltfDocument::named(const char* list, const GltfItem& index) const {
  if (!root().has(list) || root().child(list).size() == 0) {
    index.at.refuse(fmt::format("{} names one of /{}, which has none", shown(index.value), list));
  }
  const GltfItem all = root().child(list);
  return all.child(static_cast<std::size_t>(index.whole(0, static_cast<Index>(all.size()) - 1)));
}

std::string GltfDocument::load(const GltfItem& uri) const {
  const std::string& text = uri.text();
  if (text.starts_with("data:")) {
    constexpr std::string_view base64 = ";base64";
    const std::size_t comma = text.find(',');
    if (comma == std::string::npos || !text.substr(0, comma).ends_with(base64)) {
      uri.at.refuse(
          fmt::format("{} is not a data URI in base64", shown(Json(text.substr(0, 100)))));
    }
    return bytes_of(std::string_view(text).substr(comma + 1), uri.at);
  }
  if (!reads_files_) {
    uri.at.refuse(
        fmt::format("{} is a file of its own: export as .glb, all in one", shown(uri.value)));
  }
  const fs::path file = file_inside(path_, text);
  if (file.empty()) {
    uri.at.refuse(fmt::format("{} is not a file in the folder of the mesh", shown(uri.value)));
  }
  std::error_code error;
  if (!fs::is_regular_file(file, error)) {
    uri.at.refuse(fmt::format("{} is not there, or no file", shown(uri.value)));
  }
  return read_file(file.string(),
                   fmt::format("{}: {}: {}", path_, uri.at.pointer, shown(uri.value)),
                   "numbers of a mesh", largest_buffers);
}

std::string_view GltfDocument::buffer(const GltfItem& index) {
  const GltfItem item = named("buffers", index);
  const GltfItem length = item.child("byteLength");
  const auto bytes = static_cast<std::size_t>(length.whole(1, Index{1} << 40));
  std::string_view data;
  if (item.has("uri")) {
    const auto number = static_cast<std::size_t>(index.value.get<double>());
    auto found = loaded_.find(number);
    if (found == loaded_.end()) {
      found = loaded_.emplace(number, load(item.child("uri"))).first;
      std::size_t total = 0;
      for (const auto& [each, content] : loaded_) total += content.size();
      if (total > largest_buffers) {
        item.at.refuse(
            fmt::format("brings the buffers to more than {} MiB", largest_buffers >> 20));
      }
    }
    data = found->second;
  } else if (index.whole(0, 1'000'000) == 0 && binary_) {
    data = *binary_;
  } else {
    item.at.refuse("has no uri, and is not the first of a .glb with a binary chunk");
  }
  if (bytes > data.size()) {
    length.at.refuse(fmt::format("{} is not <= {}, the bytes that are there", bytes, data.size()));
  }
  return data.substr(0, bytes);
}

}  // namespace nuno
