#include <nuno/scene_file.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <numeric>
#include <set>
#include <span>

namespace nuno {
namespace {

using Json = nlohmann::ordered_json;

/// A place in a scene file, for messages.
struct Field {
  const std::string& source;
  std::string pointer;

  Field child(std::string_view name) const { return {source, fmt::format("{}/{}", pointer, name)}; }

  [[noreturn]] void refuse(const std::string& what) const {
    throw InputError(fmt::format("{}: {}: {}", source, pointer.empty() ? "/" : pointer, what));
  }
};

/// A value as a message shows it: on one line, cut where it is long.
std::string shown(const Json& value) {
  std::string text = value.dump(-1, ' ', true, Json::error_handler_t::replace);
  if (text.size() > 60) text = text.substr(0, 57) + "...";
  return text;
}

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
    // The name is the user's text: quoted and escaped as JSON, it stays on one line.
    std::string quoted = shown(Json(item.key()));
    at.child(quoted.substr(1, quoted.size() - 2))
        .refuse(fmt::format("{} is not a known field; the nearest is \"{}\"", quoted, nearest));
  }
}

double number(const Json& value, const Field& at) {
  if (!value.is_number()) at.refuse(fmt::format("{} is not a number", shown(value)));
  return value.get<double>();
}

void read(const Json& object, const Field& parent, const char* name, double& into) {
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
  const Field at = parent.child(name);
  if (!object.contains(name)) at.refuse("is missing; it is required");
  const Json& points = object[name];
  if (!points.is_array()) at.refuse(fmt::format("{} is not an array of points", shown(points)));
  into.resize(2, static_cast<Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Field point_at = at.child(std::to_string(i));
    if (!points[i].is_array() || points[i].size() != 2) {
      point_at.refuse(fmt::format("{} is not a point [x, y]", shown(points[i])));
    }
    for (std::size_t row = 0; row < 2; ++row) {
      into(static_cast<Index>(row), static_cast<Index>(i)) =
          number(points[i][row], point_at.child(std::to_string(row)));
    }
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

/// The JSON of `text`; an InputError for what is no JSON or names a field of an object twice.
Json parse_json(const std::string& text, const std::string& source) {
  std::vector<std::set<std::string>> names;
  // A scene is three deep. Far deeper values could not even be shown without running out of stack.
  constexpr int deepest = 16;
  const auto watch = [&](int depth, Json::parse_event_t event, Json& value) {
    if (depth > deepest) {
      throw InputError(
          fmt::format("{}: /: not a scene: nested more than {} deep", source, deepest));
    }
    if (event == Json::parse_event_t::object_start) {
      names.emplace_back();
    } else if (event == Json::parse_event_t::object_end) {
      names.pop_back();
    } else if (event == Json::parse_event_t::key &&
               !names.back().insert(value.get<std::string>()).second) {
      throw InputError(fmt::format("{}: /: {} stands twice in one object", source, shown(value)));
    }
    return true;
  };
  try {
    return Json::parse(text, watch);
  } catch (const Json::exception& error) {
    std::string what = error.what();  // "[json.exception.…] message", possibly over several lines
    if (const auto end = what.find("] "); end != std::string::npos) what = what.substr(end + 2);
    std::ranges::replace_if(
        what, [](char c) { return static_cast<unsigned char>(c) < ' '; }, ' ');
    throw InputError(fmt::format("{}: /: not JSON: {}", source, what));
  }
}

Json to_json(const Points& points) {
  Json array = Json::array();
  for (Index i = 0; i < points.cols(); ++i) array.push_back({points(0, i), points(1, i)});
  return array;
}

}  // namespace

ChainScene parse_scene(const std::string& text, const std::string& source) {
  const Json json = parse_json(text, source);
  const Field root{source, ""};
  static constexpr std::array<std::string_view, 15> known = {
      "nuno_scene", "name",          "particles",     "arrival_time", "gravity",
      "initial",    "target",        "cloth",         "launch",       "reference",
      "arrival",    "damping_ratio", "target_length", "time_step",    "frames_per_second"};
  static constexpr std::array<std::string_view, 6> known_cloth = {
      "mass",         "air_drag", "stretch_stiffness", "stretch_damping", "hinge_stiffness",
      "hinge_damping"};
  require_known_fields(json, root, known);
  if (!json.contains("nuno_scene")) root.child("nuno_scene").refuse("is missing; it is required");
  if (json["nuno_scene"] != 1) {
    root.child("nuno_scene").refuse(fmt::format("{} is not 1", shown(json["nuno_scene"])));
  }
  if (!json.contains("arrival_time")) {
    root.child("arrival_time").refuse("is missing; it is required");
  }

  ChainScene scene;
  scene.name = std::filesystem::path(source).stem().string();
  read(json, root, "name", scene.name);
  read(json, root, "particles", scene.particles);
  read(json, root, "arrival_time", scene.arrival_time);
  read(json, root, "gravity", scene.gravity);
  read(json, root, "initial", scene.initial);
  read(json, root, "target", scene.target);
  if (json.contains("cloth")) {
    const Json& cloth = json["cloth"];
    const Field at = root.child("cloth");
    require_known_fields(cloth, at, known_cloth);
    read(cloth, at, "mass", scene.cloth.mass);
    read(cloth, at, "air_drag", scene.cloth.air_drag);
    read(cloth, at, "stretch_stiffness", scene.cloth.stretch_stiffness);
    read(cloth, at, "stretch_damping", scene.cloth.stretch_damping);
    read(cloth, at, "hinge_stiffness", scene.cloth.hinge_stiffness);
    read(cloth, at, "hinge_damping", scene.cloth.hinge_damping);
  }
  read(json, root, "launch", launch_words, scene.launch);
  read(json, root, "reference", reference_words, scene.reference);
  read(json, root, "arrival", arrival_words, scene.arrival);
  read(json, root, "damping_ratio", scene.damping_ratio);
  read(json, root, "target_length", target_length_words, scene.target_length);
  if (json.contains("time_step")) {
    scene.time_step = number(json["time_step"], root.child("time_step"));
  }
  read(json, root, "frames_per_second", scene.frames_per_second);

  validate(scene, source);
  return scene;
}

ChainScene read_scene(const std::string& path) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) {
    throw InputError(fmt::format("{}: /: is a directory, not a scene file", path));
  }
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError(fmt::format("{}: /: cannot be opened for reading", path));
  const std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  if (file.bad()) throw InputError(fmt::format("{}: /: cannot be read", path));
  return parse_scene(text, path);
}

std::string to_json(const ChainScene& scene) {
  Json json;
  json["nuno_scene"] = 1;
  json["name"] = scene.name;
  json["particles"] = scene.particles;
  json["arrival_time"] = scene.arrival_time;
  json["gravity"] = scene.gravity;
  json["initial"] = to_json(scene.initial);
  json["target"] = to_json(scene.target);
  json["cloth"] = {{"mass", scene.cloth.mass},
                   {"air_drag", scene.cloth.air_drag},
                   {"stretch_stiffness", scene.cloth.stretch_stiffness},
                   {"stretch_damping", scene.cloth.stretch_damping},
                   {"hinge_stiffness", scene.cloth.hinge_stiffness},
                   {"hinge_damping", scene.cloth.hinge_damping}};
  json["launch"] = word_for(launch_words, scene.launch);
  json["reference"] = word_for(reference_words, scene.reference);
  json["arrival"] = word_for(arrival_words, scene.arrival);
  json["damping_ratio"] = scene.damping_ratio;
  json["target_length"] = word_for(target_length_words, scene.target_length);
  if (scene.time_step) json["time_step"] = *scene.time_step;
  json["frames_per_second"] = scene.frames_per_second;
  return json.dump(1);
}

}  // namespace nuno
