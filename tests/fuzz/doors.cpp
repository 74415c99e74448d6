#include "fuzz/doors.h"

#include <nuno/drawing.h>
#include <nuno/engines.h>
#include <nuno/output.h>
#include <nuno/rollout.h>
#include <nuno/scene_file.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <utility>
#include <variant>
#include <vector>

#include "pictures/drawn_result.h"
#include "pictures/flight_figure.h"
#include "temporary_folder.h"

namespace nuno::fuzz {
namespace {

constexpr double little_work = 2e4;  // particle-steps

void require_text(const std::string& text) {
  require(printable(text) == text, "not one line of UTF-8", text);
}

void fly(const SceneFile& file) {
  for (const std::string_view engine : engines_for(file.problem)) {
    const auto backend = make_backend(engine, file);
    const auto particles = static_cast<double>(file.problem.cloth().particles());
    if (static_cast<double>(backend->steps()) * particles > little_work) continue;
    const Rollout flight = rollout(*backend, 0.1 * objective(*backend).gain_scale);
    if (flight.status == RolloutStatus::diverged) {
      require_text(flight.reason);
      continue;
    }
    require(flight.final.allFinite(), "a flight that is ok is not finite", file.path);
  }
}

/// A scene as a throw would have it, but short.
template <typename AScene>
AScene short_scene() {
  AScene scene;
  scene.arrival_time = 0.1;
  return scene;
}

void fly_drawing(const std::string& initial, const std::string& target) {
  ChainScene scene = short_scene<ChainScene>();
  scene.particles = 8;
  fly(make_scene_file("drawing", with_drawings(std::move(scene), initial, target, "drawing")));
}

void fly_mesh(const std::string& initial, const std::string& target) {
  const SheetInput input = with_meshes(short_scene<SheetScene>(), initial, target, "mesh");
  for (const std::string& remark : input.mesh.remarks) require_text(printable(remark));
  fly(make_scene_file("mesh", input));
}

/// The input as a file, in a folder with nothing else in it.
std::string written(const std::string& input, const std::string& name) {
  static const TemporaryFolder folder;
  const std::string path = folder / name;
  std::ofstream(path, std::ios::binary) << input;
  return path;
}

/// A drawing without its texts, which may hold any word of its user's.
std::string tags_of(const std::string& svg) {
  std::string tags;
  for (std::size_t at = 0; (at = svg.find('<', at)) != svg.npos;) {
    const std::size_t end = std::min(svg.find('>', at), svg.size());
    tags.append(svg, at, end - at);
    at = end;
  }
  return tags;
}

/// Whether `work` is done; not where it refuses.
template <typename Work>
bool is_let_in(const Work& work) {
  try {
    work();
    return true;
  } catch (const InputError& error) {
    // As people see it: a name may hold any byte. Cut where it stands, not just before it is told.
    const std::string said = message_for_people(error.what());
    require_text(said);
    require(said == printable(error.what()), "a long message", error.what());
    return false;
  }
}

}  // namespace

void require(bool right, const char* what, std::string_view about) {
  if (right) return;
  const std::string shown(about.substr(0, 2000));
  std::fprintf(stderr, "%s: %s\n", what, shown.c_str());
  std::abort();
}

bool enter_scene(const std::string& input, Patience) {
  ChainScene scene = parse_scene(input, "scene.json");
  const std::string json = to_json(scene);
  require(to_json(parse_scene(json, "written.json")) == json, "not read as written", json);
  if (scene.particles > 10'000) return true;  // resampling them takes its time
  fly(make_scene_file("scene.json", std::move(scene)));
  return true;
}

bool enter_sheet_scene(const std::string& input, Patience) {
  AnyScene scene = parse_any_scene(input, NUNO_SCENES "/sheets/scene.json");
  if (const auto* chain = std::get_if<ChainScene>(&scene)) return chain->particles > 0;
  fly(make_scene_file("scene.json", std::move(scene)));
  return true;
}

bool enter_obj(const std::string& input, Patience) {
  const std::string path = written(input, "input.obj");
  is_drawing(path) ? fly_drawing(path, path) : fly_mesh(path, path);
  return true;
}

bool enter_ply(const std::string& input, Patience) {
  const std::string path = written(input, "input.ply");
  fly_mesh(path, path);
  return true;
}

bool enter_gltf(const std::string& input, Patience) {
  const std::string path = written(input, "input.glb");
  const bool has_pose = is_let_in([&] { fly_mesh(path, path + "#"); });  // its only morph target
  if (!has_pose) fly_mesh(path, path);
  return true;
}

bool enter_svg(const std::string& input, Patience) {
  const std::string path = written(input, "input.svg");
  const bool has_two = is_let_in([&] { fly_drawing(path + "#initial", path + "#target"); });
  if (!has_two) fly_drawing(path, path);
  return true;
}

bool enter_csv(const std::string& input, Patience) {
  const std::string path = written(input, "input.csv");
  fly_drawing(path, path);
  return true;
}

bool enter_result(const std::string& input, Patience) {
  if (is_scene(input, "result.json")) return false;
  const std::vector flights = {parse_result(input, "result.json")};
  if (flights[0].positions.size() * static_cast<std::size_t>(flights[0].target.cols()) > 2000) {
    return true;
  }
  const auto figure = figures::captioned(flights, false);
  for (const std::string& svg : {figures::draw_flights(flights, figure).svg(),
                                 figures::draw_motion(flights, 1, figure).svg()}) {
    std::string lines = svg;
    for (char& c : lines) c = c == '\n' ? ' ' : c;
    require_text(lines);
    const std::string tags = tags_of(svg);
    require(tags.find("nan") == svg.npos && tags.find("inf") == svg.npos, "NaN in a drawing", svg);
  }
  return true;
}

bool enter(const Door& door, const std::string& input, Patience patience) {
  bool is_answered = false;
  return is_let_in([&] { is_answered = door.enter(input, patience); }) && is_answered;
}

}  // namespace nuno::fuzz
