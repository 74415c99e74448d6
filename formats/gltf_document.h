#pragma once

#include <nuno/points.h>

#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "json_field.h"

namespace nuno {

/// A value of a glTF file and its place there. All that is asked for is refused, with that place,
/// where it is not as asked.
struct GltfItem {
  const nlohmann::ordered_json& value;
  Field at;

  bool has(const char* name) const;
  GltfItem child(const char* name) const;      ///< required
  GltfItem child(std::size_t number) const;    ///< of an array, below its size
  std::size_t size() const;                    ///< of an array
  Index whole(Index least, Index most) const;  ///< a whole number
  double number() const;                       ///< within those of a scene
  const std::string& text() const;
  /// Of a field that may be missing.
  Index whole(const char* name, Index otherwise, Index least, Index most) const;
};

/// What an accessor must be to serve.
struct GltfUse {
  const char* type;       ///< SCALAR, VEC2, VEC3
  bool is_index = false;  ///< unsigned integers, else numbers of any type but those of 32 bits
  Index most;             ///< elements
};

/// A glTF 2.0 file, .gltf or .glb. Its buffers are read when they are asked for, from the file, a
/// data URI, or a file in its own folder or below; nothing else is read.
class GltfDocument {
 public:
  /// Throws InputError.
  explicit GltfDocument(const std::string& path);
  /// Of the bytes of the file called `path`; no other file is read.
  GltfDocument(std::string bytes, const std::string& path);
  GltfDocument(const GltfDocument&) = delete;
  GltfDocument& operator=(const GltfDocument&) = delete;

  GltfItem root() const { return {json_, {path_, ""}}; }

  /// The item of a list of the document that `index` names.
  GltfItem named(const char* list, const GltfItem& index) const;

  /// The accessor's elements, a column each, with its sparse ones; integers that are normalised are
  /// numbers within −1 … 1.
  Points elements(const GltfItem& index, const GltfUse& use);

 private:
  /// Elements in a buffer view, `stride` bytes apart.
  struct Elements {
    const char* data = nullptr;
    std::size_t stride = 0;
  };

  void split_container();
  std::string_view buffer(const GltfItem& index);
  std::string load(const GltfItem& uri) const;
  Elements find(const GltfItem& holder, Index count, std::size_t size);
  void put_sparse(const GltfItem& sparse, std::size_t component_type, bool is_normalised,
                  Points& into);

  void parse();

  std::string path_, text_;
  bool reads_files_ = true;
  nlohmann::ordered_json json_;
  std::optional<std::string_view> binary_;  ///< a .glb's own buffer, in text_
  std::map<std::size_t, std::string> loaded_;
};

}  // namespace nuno
