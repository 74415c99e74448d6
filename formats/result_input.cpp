// What of a result file is read, to fly it again.

#include <nuno/input.h>
#include <nuno/reference_motion.h>
#include <nuno/scene_file.h>

#include <cmath>
#include <filesystem>
#include <limits>

#include "compact_json.h"
#include "json_field.h"
#include "scene_json.h"

namespace nuno {
namespace {

using Json = nlohmann::ordered_json;

const JsonForm result_form = {.points = {{"/input/initial", 0},
                                         {"/input/target", 0},
                                         {"/input/initial/vertices", 0},
                                         {"/input/initial/texture_coordinates", 0},
                                         {"/input/target/vertices", 0},
                                         {"/reference_correction", 1}},
                              .wanted = {"nuno_result", "input", "backend", "alpha", "alphas",
                                         "steps", "reference_correction"},
                              .lists = {{"/input/initial/faces", most_file_faces},
                                        {"/input/initial/texture_corners", most_file_faces},
                                        {"/input/initial/file_vertices", most_file_vertices}},
                              .longest_list = 64};

const Json& require(const Json& result, const Field& root, const char* name) {
  if (!result.contains(name)) root.child(name).refuse("is missing; it is required");
  return result[name];
}

double gain(const Json& value, const Field& at) {
  const double number = value.is_number() ? value.get<double>() : -1;
  if (!(number >= 0 && std::isfinite(number))) {
    at.refuse(fmt::format("{} is not a number >= 0", shown(value)));
  }
  return number;
}

Gains gains(const Json& result, const Field& root) {
  if (!result.contains("alphas")) {
    return gain(require(result, root, "alpha"), root.child("alpha"));
  }
  const Json& list = result["alphas"];
  const Field at = root.child("alphas");
  if (!list.is_array() || list.empty() || list.size() > static_cast<std::size_t>(most_groups)) {
    at.refuse(fmt::format("{} is not a list of 1 … {} gains", shown(list), most_groups));
  }
  std::vector<double> groups;
  for (const Json& value : list) {
    groups.push_back(gain(value, at.child(std::to_string(groups.size()))));
  }
  return Gains::of_groups(groups);
}

/// Of `particles` particles in so many dimensions.
std::vector<Points> correction(const Json& result, const Field& root, Index dimension,
                               Index particles) {
  std::vector<Points> shapes;
  if (!result.contains("reference_correction")) return shapes;
  const Field at = root.child("reference_correction");
  const Json& list = result["reference_correction"];
  if (!list.is_array() || list.size() != correction_powers.size()) {
    at.refuse(fmt::format("{} is not a list of {} shapes", shown(list), correction_powers.size()));
  }
  for (const Json& value : list) {
    const Points shape = value.is_binary() ? points_of(value) : Points();
    if (shape.rows() != dimension || shape.cols() != particles ||
        !(shape.cwiseAbs().maxCoeff() <= largest_scene_number)) {
      at.child(std::to_string(shapes.size()))
          .refuse(fmt::format("{} is not a shape of {} particles", shown(value), particles));
    }
    shapes.push_back(shape);
  }
  return shapes;
}

/// The scene in a result: messages of it point into /input.
AnyScene input_of(const Json& json, const std::string& source, const std::string& folder) {
  try {
    return scene_from(json, source, folder);
  } catch (const InputError& error) {
    const std::string message = error.what(), start = source + ": /";
    if (!message.starts_with(start)) throw;
    const std::string rest = message.substr(start.size());
    throw InputError(start + "input" + (rest.starts_with(":") ? "" : "/") + rest);
  }
}

SceneOrResult read_result(const Json& result, const std::string& source,
                          const std::string& folder) {
  const Field root{source, ""};
  if (result["nuno_result"] != 1) {
    root.child("nuno_result").refuse(fmt::format("{} is not 1", shown(result["nuno_result"])));
  }
  AnyScene scene = input_of(require(result, root, "input"), source, folder);
  PastFlight flight;
  const Json& backend = require(result, root, "backend");
  if (!backend.is_string()) {
    root.child("backend").refuse(fmt::format("{} is not a string", shown(backend)));
  }
  flight.backend = backend.get<std::string>();
  flight.gains = gains(result, root);
  const Json& steps = require(result, root, "steps");
  const double number = steps.is_number() ? steps.get<double>() : 0;
  if (!(number >= 1 && number <= 1e15 && number == std::floor(number))) {
    root.child("steps").refuse(fmt::format("{} is not a whole number >= 1", shown(steps)));
  }
  flight.steps = static_cast<Index>(number);
  const auto* const chain = std::get_if<ChainScene>(&scene);
  flight.reference_correction =
      correction(result, root, chain ? 2 : 3,
                 chain ? chain->particles : std::get<SheetInput>(scene).scene.initial.cols());
  return {std::move(scene), std::move(flight)};
}

}  // namespace

SceneOrResult read_scene_or_result(const std::string& path) {
  const std::string text = read_input(path);
  if (text.find("\"nuno_result\"") != std::string::npos) {
    const std::string source = name_of_input(path);
    const Json json = parse_compact(text, source, result_form);
    if (json.is_object() && json.contains("nuno_result")) {
      return read_result(json, source, std::filesystem::path(path).parent_path().string());
    }
  }
  return {parse_any_scene(text, path), std::nullopt};
}

}  // namespace nuno
