#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <vector>

#include "compact_json.h"
#include "gltf_document.h"

namespace nuno {
namespace {

struct ComponentType {
  Index code;
  std::size_t size;  ///< bytes
  bool is_index;     ///< unsigned, as those of vertices are
};

constexpr std::size_t float_type = 5;
constexpr std::array component_types = {
    ComponentType{5120, 1, false}, ComponentType{5121, 1, true}, ComponentType{5122, 2, false},
    ComponentType{5123, 2, true},  ComponentType{5125, 4, true}, ComponentType{5126, 4, false}};

/// The place of the item's component type in the table above.
std::size_t component_type(const GltfItem& holder, bool is_index) {
  const GltfItem code = holder.child("componentType");
  for (std::size_t i = 0; i < component_types.size(); ++i) {
    const bool serves = is_index ? component_types[i].is_index : component_types[i].code != 5125;
    if (serves && code.value == component_types[i].code) return i;
  }
  code.at.refuse(fmt::format("{} is not {}", shown(code.value),
                             is_index ? "5121, 5123 or 5125, a type of indices"
                                      : "5120, 5121, 5122, 5123 or 5126, a type of coordinates"));
}

template <typename Number>
double stored(const char* data, bool is_normalised) {
  Number number = 0;
  std::memcpy(&number, data, sizeof number);
  if (!is_normalised) return static_cast<double>(number);
  return std::max(
      -1.0, static_cast<double>(number) / static_cast<double>(std::numeric_limits<Number>::max()));
}

double component(const char* data, std::size_t type, bool is_normalised) {
  switch (type) {
    case 0:
      return stored<std::int8_t>(data, is_normalised);
    case 1:
      return stored<std::uint8_t>(data, is_normalised);
    case 2:
      return stored<std::int16_t>(data, is_normalised);
    case 3:
      return stored<std::uint16_t>(data, is_normalised);
    case 4:
      return stored<std::uint32_t>(data, is_normalised);
    default:
      return stored<float>(data, false);
  }
}

}  // namespace

GltfDocument::Elements GltfDocument::find(const GltfItem& holder, Index count, std::size_t size) {
  constexpr Index most_bytes = Index{1} << 40;
  const GltfItem view = named("bufferViews", holder.child("bufferView"));
  const std::string_view data = buffer(view.child("buffer"));
  const Index start = view.whole("byteOffset", 0, 0, most_bytes);
  const GltfItem length = view.child("byteLength");
  const Index bytes = length.whole(1, most_bytes);
  if (start + bytes > static_cast<Index>(data.size())) {
    length.at.refuse(
        fmt::format("{} from byte {} on is not within the buffer's {}", bytes, start, data.size()));
  }
  const auto least = static_cast<Index>(size);
  const Index stride = view.whole("byteStride", least, least, 252);
  const Index offset = holder.whole("byteOffset", 0, 0, most_bytes);
  const Index end = offset + (count - 1) * stride + least;
  if (end > bytes) {
    holder.at.refuse(fmt::format("{} elements end at byte {}, not within the {} of their view",
                                 count, end, bytes));
  }
  return {data.data() + start + offset, static_cast<std::size_t>(stride)};
}

void GltfDocument::put_sparse(const GltfItem& sparse, std::size_t type, bool is_normalised,
                              Points& into) {
  const Index count = sparse.child("count").whole(1, into.cols());
  const GltfItem indices = sparse.child("indices"), values = sparse.child("values");
  const std::size_t index_type = component_type(indices, true), size = component_types[type].size;
  const Elements numbers = find(indices, count, component_types[index_type].size);
  const Elements elements = find(values, count, static_cast<std::size_t>(into.rows()) * size);
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
    const double number = component(numbers.data + i * numbers.stride, index_type, false);
    if (number >= static_cast<double>(into.cols())) {
      indices.at.refuse(
          fmt::format("{}, index {}, is not within 0 … {}", number, i, into.cols() - 1));
    }
    for (Index row = 0; row < into.rows(); ++row) {
      into(row, static_cast<Index>(number)) =
          component(elements.data + i * elements.stride + static_cast<std::size_t>(row) * size,
                    type, is_normalised);
    }
  }
}

Points GltfDocument::elements(const GltfItem& index, const GltfUse& use) {
  const GltfItem accessor = named("accessors", index);
  const GltfItem kind = accessor.child("type");
  if (kind.text() != use.type) {
    kind.at.refuse(fmt::format("{} is not \"{}\"", shown(kind.value), use.type));
  }
  const std::size_t type = component_type(accessor, use.is_index);
  const bool is_normalised =
      accessor.has("normalized") && accessor.value["normalized"] == true && !use.is_index;
  const Index count = accessor.child("count").whole(1, use.most);
  const std::size_t size = component_types[type].size;
  const std::string_view name = use.type;
  Points result = Points::Zero(name == "VEC3" ? 3 : name == "VEC2" ? 2 : 1, count);
  if (accessor.has("bufferView")) {
    const Elements found = find(accessor, count, static_cast<std::size_t>(result.rows()) * size);
    for (Index i = 0; i < count; ++i) {
      const char* data = found.data + static_cast<std::size_t>(i) * found.stride;
      for (Index row = 0; row < result.rows(); ++row, data += size) {
        result(row, i) = component(data, type, is_normalised);
      }
    }
  }
  if (accessor.has("sparse")) put_sparse(accessor.child("sparse"), type, is_normalised, result);
  if (type != float_type) return result;
  for (Index i = 0; i < result.size(); ++i) {
    if (!(std::abs(result(i)) <= largest_scene_number)) {
      accessor.at.refuse(fmt::format("{}, in element {}, is not within ±{}", result(i),
                                     i / result.rows(), largest_scene_number));
    }
  }
  return result;
}

}  // namespace nuno
