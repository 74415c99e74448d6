#include <nuno/input.h>
#include <nuno/materials.h>
#include <nuno/scene_file.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>
#include <span>
#include <type_traits>
#include <vector>

#include "compact_json.h"
#include "json_field.h"
#include "scene_json.h"
#include "scene_mesh.h"

namespace nuno {
namespace {

using Json = nlohmann::ordered_json;

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t substituted = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, substituted});
    }
  }
  return row.back();
}

void require_known_fields(const Json& object, const Field& at,
                          std::span<const std::string_view> known) {
  if (!object.is_object()) at.refuse(fmt::format("{} is not an object", shown(object)));
  for (const auto& item : object.items()) {
    const std::string_view name = std::string_view(item.key()).substr(0, 64);
    if (std::ranges::find(known, item.key()) != known.end()) continue;
    const auto nearest = *std::ranges::min_element(
        known, {}, [&](std::string_view candidate) { return edit_distance(name, candidate); });
    at.child(shown_name(item.key()))
        .refuse(fmt::format("{} is not a known field; the nearest is \"{}\"",
                            shown(Json(item.key())), nearest));
  }
}

double number(const Json& value, const Field& at) {
  if (!value.is_number()) at.refuse(fmt::format("{} is not a number", shown(value)));
  return value.get<double>();
}

void read(const Json& object, const Field& parent, const char* name, double& into) {
  if (object.contains(name)) into = number(object[name], parent.child(name));
}

void read(const Json& object, const Field& parent, const char* name, std::optional<double>& into) {
  if (object.contains(name)) into = number(object[name], parent.child(name));
}

void read(const Json& object, const Field& parent, const char* name, Index& into) {
  if (!object.contains(name)) return;
  const Field at = parent.child(name);
  const double value = number(object[name], at);
  if (value != std::floor(value) || std::abs(value) > 1e15) {
    at.refuse(fmt::format("{} is not a whole number", shown(object[name])));
  }
  into = static_cast<Index>(value);
}

void read(const Json& object, const Field& parent, const char* name, std::string& into) {
  if (!object.contains(name)) return;
  if (!object[name].is_string()) {
    parent.child(name).refuse(fmt::format("{} is not a string", shown(object[name])));
  }
  into = object[name].get<std::string>();
}

void read(const Json& object, const Field& parent, const char* name, Points& into) {
  const Json& points = object[name];
  if (points.is_array()) {  // only one without points comes as a list
    into.resize(2, 0);
    return;
  }
  const Field at = parent.child(name);
  if (!points.is_binary()) at.refuse(fmt::format("{} is not an array of points", shown(points)));
  into = points_of(points);
  if (into.rows() != 2) {
    at.child("0").refuse(fmt::format("[{}] is not a point [x, y]", fmt::join(into.col(0), ",")));
  }
}

template <typename Enum>
struct Word {
  std::string_view text;
  Enum value;
};

constexpr std::array launch_words = {Word<Launch>{"ballistic", Launch::ballistic},
                                     Word<Launch>{"inextensible", Launch::inextensible}};
constexpr std::array reference_words = {Word<Reference>{"hold", Reference::hold},
                                        Word<Reference>{"morph", Reference::morph}};
constexpr std::array arrival_words = {Word<Arrival>{"pass", Arrival::pass},
                                      Word<Arrival>{"settle", Arrival::settle}};
constexpr std::array target_length_words = {Word<TargetLength>{"fit", TargetLength::fit},
                                            Word<TargetLength>{"as-drawn", TargetLength::as_drawn}};
constexpr std::array target_order_words = {Word<TargetOrder>{"as-drawn", TargetOrder::as_drawn},
                                           Word<TargetOrder>{"reversed", TargetOrder::reversed}};
constexpr std::array rest_words = {Word<Rest>{"initial", Rest::initial},
                                   Word<Rest>{"flat", Rest::flat}};

template <typename Words, typename Enum>
void read(const Json& object, const Field& parent, const char* name, const Words& words,
          Enum& into) {
  if (!object.contains(name)) return;
  for (const auto& word : words) {
    if (object[name] == word.text) {
      into = word.value;
      return;
    }
  }
  parent.child(name).refuse(
      fmt::format("{} is not \"{}\" or \"{}\"", shown(object[name]), words[0].text, words[1].text));
}

template <typename Words, typename Enum>
std::string_view word_for(const Words& words, Enum value) {
  return std::ranges::find(words, value, [](const auto& word) { return word.value; })->text;
}

constexpr std::array<std::string_view, 2> shape_fields = {"initial", "target"};

/// A scene's fields take numbers and words, but for its shapes.
const JsonForm scene_form = {.points = {{"/initial", 0},
                                        {"/target", 0},
                                        {"/initial/vertices", 0},
                                        {"/initial/texture_coordinates", 0},
                                        {"/target/vertices", 0}},
                             .lists = {{"/initial/faces", most_file_faces},
                                       {"/initial/texture_corners", most_file_faces},
                                       {"/initial/file_vertices", most_file_vertices}},
                             .longest_list = 64};

// Every field of a scene file stands here once, with the words that it may have; what lists, reads
// and writes scenes visits them.

template <typename SceneOf, typename Visit>
void visit_first(SceneOf& scene, Visit&& visit) {
  visit("name", scene.name);
  if constexpr (requires { scene.particles; }) visit("particles", scene.particles);
  visit("arrival_time", scene.arrival_time);
  visit("gravity", scene.gravity);
}

template <typename SceneOf, typename Visit>
void visit_last(SceneOf& scene, Visit&& visit) {
  if constexpr (requires { scene.rest; }) visit("rest", scene.rest, rest_words);
  visit("launch", scene.launch, launch_words);
  visit("reference", scene.reference, reference_words);
  visit("arrival", scene.arrival, arrival_words);
  visit("damping_ratio", scene.damping_ratio);
  visit("target_length", scene.target_length, target_length_words);
  if constexpr (requires { scene.target_order; }) {
    visit("target_order", scene.target_order, target_order_words);
  }
  visit("time_step", scene.time_step);
  visit("frames_per_second", scene.frames_per_second);
}

template <typename Visit>
void visit_material(std::convertible_to<const ChainMaterial&> auto& cloth, Visit&& visit) {
  visit("mass", cloth.mass);
  visit("air_drag", cloth.air_drag);
  visit("stretch_stiffness", cloth.stretch_stiffness);
  visit("stretch_damping", cloth.stretch_damping);
  visit("hinge_stiffness", cloth.hinge_stiffness);
  visit("hinge_damping", cloth.hinge_damping);
}

template <typename Visit>
void visit_material(std::convertible_to<const SheetMaterial&> auto& cloth, Visit&& visit) {
  visit("areal_density", cloth.areal_density);
  visit("air_drag", cloth.air_drag);
  visit("stretch_stiffness", cloth.stretch_stiffness);
  visit("stretch_damping", cloth.stretch_damping);
  visit("shear_stiffness", cloth.shear_stiffness);
  visit("shear_damping", cloth.shear_damping);
  visit("bending_stiffness", cloth.bending_stiffness);
  visit("bending_damping", cloth.bending_damping);
}

/// Reads each field that `object`, at `at`, has.
struct FieldReader {
  const Json& object;
  const Field& at;
  void operator()(const char* name, auto& into, const auto&... words) const {
    read(object, at, name, words..., into);
  }
};

/// Notes each field's name.
struct FieldLister {
  std::vector<std::string_view>& names;
  void operator()(const char* name, const auto&...) const { names.emplace_back(name); }
};

/// Writes each field that has a value.
struct FieldWriter {
  Json& object;
  void operator()(const char* name, const auto& value) const { object[name] = value; }
  void operator()(const char* name, const std::optional<double>& value) const {
    if (value) object[name] = *value;
  }
  void operator()(const char* name, auto value, const auto& words) const {
    object[name] = word_for(words, value);
  }
};

/// Throws InputError for a field that no scene of this form has, or one that is missing; `shapes`
/// are the names of the fields that hold those.
template <typename SceneOf>
void require_fields(const Json& json, const Field& root,
                    std::span<const std::string_view> shapes = shape_fields) {
  std::vector<std::string_view> known = {"nuno_scene"};
  known.insert(known.end(), shapes.begin(), shapes.end());
  known.emplace_back("cloth");
  if constexpr (std::is_same_v<SceneOf, SheetScene>) known.emplace_back("material");
  SceneOf scene;
  visit_first(scene, FieldLister{known});
  visit_last(scene, FieldLister{known});
  require_known_fields(json, root, known);
  std::vector<std::string_view> required = {"nuno_scene", "arrival_time"};
  required.insert(required.end(), shapes.begin(), shapes.end());
  for (const std::string_view name : required) {
    if (!json.contains(name)) root.child(name).refuse("is missing; it is required");
    if (name == "nuno_scene" && json[name] != 1) {
      root.child(name).refuse(fmt::format("{} is not 1", shown(json[name])));
    }
  }
}

void read_material(const Json& json, const Field& root, auto& cloth) {
  if (!json.contains("cloth")) return;
  const Field at = root.child("cloth");
  std::vector<std::string_view> known;
  visit_material(cloth, FieldLister{known});
  require_known_fields(json["cloth"], at, known);
  visit_material(cloth, FieldReader{json["cloth"], at});
}

bool names_meshes(const Json& json) {
  return json.is_object() && json.contains("initial") && json["initial"].is_string();
}

bool has_meshes(const Json& json) {
  return json.is_object() && json.contains("initial") && json["initial"].is_object();
}

/// Every field but for the shapes.
void read_fields(const Json& json, const Field& root, ChainScene& scene) {
  scene.name = std::filesystem::path(root.source).stem().string();
  visit_first(scene, FieldReader{json, root});
  read_material(json, root, scene.cloth);
  visit_last(scene, FieldReader{json, root});
}

ChainScene read_chain(const Json& json, const std::string& source) {
  const Field root{source, ""};
  require_fields<ChainScene>(json, root);
  ChainScene scene;
  read(json, root, "initial", scene.initial);
  read(json, root, "target", scene.target);
  read_fields(json, root, scene);
  validate(scene, source);
  return scene;
}

/// Starts from the values of the material that the scene names.
void read_named_material(const Json& json, const Field& root, SheetMaterial& cloth) {
  if (!json.contains("material")) return;
  std::string name;
  read(json, root, "material", name);
  if (const NamedMaterial* const found = find_material(name)) {
    cloth = found->cloth;
  } else {
    root.child("material")
        .refuse(fmt::format("{} is not one of {}", shown(json["material"]), material_names()));
  }
}

void read_fields(const Json& json, const Field& root, SheetScene& scene) {
  scene.name = std::filesystem::path(root.source).stem().string();
  visit_first(scene, FieldReader{json, root});
  read_named_material(json, root, scene.cloth);
  read_material(json, root, scene.cloth);
  visit_last(scene, FieldReader{json, root});
}

SheetInput read_sheet_of_files(const Json& json, const std::string& source,
                               const std::filesystem::path& folder) {
  const Field root{source, ""};
  require_fields<SheetScene>(json, root);
  SheetScene scene;
  std::string initial, target;
  read(json, root, "initial", initial);
  read(json, root, "target", target);
  read_fields(json, root, scene);
  return with_meshes(std::move(scene), (folder / initial).string(), (folder / target).string(),
                     source);
}

SheetInput read_whole_sheet(const Json& json, const std::string& source) {
  const Field root{source, ""};
  require_fields<SheetScene>(json, root);
  SheetScene scene;
  read_fields(json, root, scene);
  Mesh mesh = mesh_in_scene(json["initial"], root.child("initial"), false);
  scene.initial = mesh.vertices;
  scene.faces = mesh.faces;
  scene.target = mesh_in_scene(json["target"], root.child("target"), true).vertices;
  validate(scene, source);
  return {std::move(scene), std::move(mesh)};
}

}  // namespace

AnyScene scene_from(const Json& json, const std::string& source, const std::string& folder) {
  if (names_meshes(json)) return read_sheet_of_files(json, source, folder);
  if (has_meshes(json)) return read_whole_sheet(json, source);
  return read_chain(json, source);
}

AnyScene parse_any_scene(const std::string& text, const std::string& path) {
  const std::string source = name_of_input(path);
  return scene_from(parse_compact(text, source, scene_form), source,
                    std::filesystem::path(path).parent_path().string());
}

AnyScene parse_whole_scene(const std::string& text, const std::string& source) {
  const Json json = parse_compact(text, source, scene_form);
  if (names_meshes(json)) {
    const Field at = Field{source, ""}.child("initial");
    at.refuse("a mesh file is not read here; give the points of a chain, or vertices and faces");
  }
  if (has_meshes(json)) return read_whole_sheet(json, source);
  return read_chain(json, source);
}

AnyScene read_scene(const std::string& path) { return parse_any_scene(read_input(path), path); }

ChainScene parse_scene(const std::string& text, const std::string& source) {
  const Json json = parse_compact(text, source, scene_form);
  if (names_meshes(json) || has_meshes(json)) {
    const Field at = Field{source, ""}.child("initial");
    at.refuse("a mesh file is not read here; give the points of a chain");
  }
  return read_chain(json, source);
}

AnyScene parse_scene_of(const Shapes& shapes, const std::string& text, const std::string& source) {
  const Json json = parse_compact(text, source, scene_form);
  const auto read = [&](auto scene) -> AnyScene {
    const Field root{source, ""};
    require_fields<decltype(scene)>(json, root, {});
    read_fields(json, root, scene);
    return with_shapes(std::move(scene), shapes, source);
  };
  return shapes.faces.empty() ? read(ChainScene()) : read(SheetScene());
}

std::string fields_to_json(const AnyScene& any) {
  Json json = {{"nuno_scene", 1}};
  const FieldWriter write{json};
  const auto add = [&](const auto& scene) {
    visit_first(scene, write);
    visit_material(scene.cloth, FieldWriter{json["cloth"]});
    visit_last(scene, write);
  };
  if (const auto* chain = std::get_if<ChainScene>(&any)) {
    add(*chain);
  } else {
    add(std::get<SheetInput>(any).scene);
  }
  return json.dump(1);
}

namespace {

/// All fields, with these shapes in their places.
template <typename SceneOf>
Json json_of_scene(const SceneOf& scene, Json initial, Json target) {
  Json json = {{"nuno_scene", 1}};
  const FieldWriter write{json};
  visit_first(scene, write);
  json["initial"] = std::move(initial);
  json["target"] = std::move(target);
  visit_material(scene.cloth, FieldWriter{json["cloth"]});
  visit_last(scene, write);
  return json;
}

}  // namespace

Json json_of(const AnyScene& any) {
  if (const auto* chain = std::get_if<ChainScene>(&any)) {
    return json_of_scene(*chain, json_of(chain->initial), json_of(chain->target));
  }
  const auto& sheet = std::get<SheetInput>(any);
  return json_of_scene(sheet.scene, json_of(sheet.mesh),
                       {{"vertices", json_of(sheet.scene.target)}});
}

std::string to_json(const ChainScene& scene) { return json_of(AnyScene(scene)).dump(1); }

std::string to_json(const SheetInput& sheet) { return json_of(AnyScene(sheet)).dump(); }

}  // namespace nuno
