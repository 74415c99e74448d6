#include "studio/uploads.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <nuno/drawing.h>

#include "formats/compact_json.h"
#include "formats/json_field.h"
#include "formats/text_file.h"

namespace nuno::studio {
namespace {

using Json = nlohmann::ordered_json;

struct File {
  std::string name, bytes;
};

const std::string& text_in(const Json& file, const Field& at, const char* name) {
  if (!file.is_object() || !file.contains(name))
    at.child(name).refuse("is missing; it is required");
  if (!file[name].is_string()) {
    at.child(name).refuse(fmt::format("{} is not a string", shown(file[name])));
  }
  return file[name].get_ref<const std::string&>();
}

File file_in(const Json& file, const Field& at) {
  File result{text_in(file, at, "name"), {}};
  const std::string& data = text_in(file, at, "data");
  if (from_base64(data, result.bytes) < data.size()) at.child("data").refuse("is not base64");
  return result;
}

Upload uploaded(const File& file, const std::string& path) {
  return {path, parse_mesh(file.bytes, path)};
}

Points curve_in(const File& file, const std::string& name) {
  if (file.name.ends_with(".csv")) return parse_csv(file.bytes, file.name);
  return parse_svg(file.bytes, file.name, name);
}

/// The only one of its file.
Points curve_in(const File& file) { return curve_in(file, ""); }

Json files_of(const std::string& body, const std::string& source) {
  Json json = parse_compact(body, source, {.wanted = {"initial", "target"}});
  if (!json.is_object()) Field{source, ""}.refuse("is not an object");
  return json;
}

}  // namespace

Drawings read_drawings(const std::string& body) {
  const std::string source = "drawings";
  const Json json = files_of(body, source);
  const Field root{source, ""};
  const bool has_both = json.contains("initial") && json.contains("target");
  const char* const only = json.contains("initial") ? "initial" : "target";
  if (has_both) {
    return {curve_in(file_in(json["initial"], root.child("initial"))),
            curve_in(file_in(json["target"], root.child("target")))};
  }
  if (!json.contains(only)) root.child(only).refuse("is missing; it is required");
  const File file = file_in(json[only], root.child(only));
  if (file.name.ends_with(".csv")) return {std::nullopt, curve_in(file)};
  try {
    return {curve_in(file, "initial"), curve_in(file, "target")};
  } catch (const InputError&) {
    return {std::nullopt, curve_in(file)};  // no such names in it
  }
}

std::pair<Upload, Upload> read_meshes(const std::string& body) {
  const std::string source = "meshes";
  const Json json = files_of(body, source);
  const Field root{source, ""};
  if (!json.contains("initial")) {
    root.child("initial").refuse("is missing; it is required");
  }
  const File start = file_in(json["initial"], root.child("initial"));
  if (json.contains("target")) {
    const File end = file_in(json["target"], root.child("target"));
    return {uploaded(start, start.name), uploaded(end, end.name)};
  }
  if (!may_have_morph_targets(start.name)) {
    throw InputError(fmt::format(
        "{}: is one mesh; give its second pose as well, or glTF with a morph target", start.name));
  }
  return {uploaded(start, start.name), uploaded(start, mesh_file(start.name) + "#")};
}

}  // namespace nuno::studio
