#include "studio/request.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cassert>
#include <charconv>
#include <cmath>

namespace nuno::studio {
namespace {

constexpr std::size_t longest_word = 64;  // of an option
constexpr Index most_frames = 2000;
constexpr double most_points_in_frames = 2e6;
constexpr double most_flights_after = 10;  // seconds after arrival, in arrival times

double most_particle_steps(const Backend& backend) {
  return backend.name() == "native" ? 5e7 : 2e7;
}

std::string quoted(const std::string& text) {
  using Json = nlohmann::json;
  return Json(text).dump(-1, ' ', false, Json::error_handler_t::replace);
}

double number(const std::string& name, const std::string& text) {
  double value = 0;
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || rest != end || !std::isfinite(value)) {
    throw InputError(fmt::format("{}: {} is not a finite number", name, quoted(text)));
  }
  if (!(value >= 0)) throw InputError(fmt::format("{}: {} is not >= 0", name, text));
  return value + 0.0;  // -0 is 0
}

template <typename Words>
std::string word(const std::string& name, const std::string& text, const Words& words) {
  if (std::ranges::find(words, text) == std::end(words)) {
    throw InputError(
        fmt::format("{}: {} is not one of {}", name, quoted(text), fmt::join(words, ", ")));
  }
  return text;
}

}  // namespace

Options read_options(const Parameters& parameters, const std::set<std::string_view>& known) {
  Options options;
  std::set<std::string_view> seen;
  for (const auto& [name, text] : parameters) {
    const std::string shown = quoted(name.substr(0, longest_word));
    if (known.empty()) throw InputError(shown + ": this request takes no options");
    if (!known.contains(name)) {
      throw InputError(fmt::format("{}: is not one of {}", shown, fmt::join(known, ", ")));
    }
    if (!seen.insert(name).second) throw InputError(fmt::format("{}: stands twice", name));
    if (text.size() > longest_word) {
      throw InputError(fmt::format("{}: is longer than {} characters", name, longest_word));
    }
    if (name == "page") {
      options.page = text;
    } else if (name == "backend") {
      options.backend = word(name, text, backend_names);
    } else if (name == "optimizer") {
      options.optimizer = word(name, text, optimizer_names);
    } else if (name == "alpha") {
      options.alpha = number(name, text);
    } else if (name == "warm_start") {
      options.warm_start = number(name, text);
    } else if (name == "refine") {
      options.refine = word(name, text, std::array{"0", "1"}) == "1";
    } else if (name == "judge") {
      options.judge = word(name, text, std::array{"0", "1"}) == "1";
    } else if (name == "format") {
      options.format = '.' + word(name, text, std::array{"glb", "pc2", "mdd", "usda"});
    } else if (name == "frames") {
      const double frames = number(name, text);
      if (frames != std::floor(frames) || frames > static_cast<double>(most_frames)) {
        throw InputError(
            fmt::format("{}: {} is not a whole number within 0 … {}", name, text, most_frames));
      }
      options.frames = static_cast<Index>(frames);
    } else {
      assert(name == "after");
      options.after = number(name, text);
    }
  }
  if (options.warm_start && options.optimizer != optimizer_names.front()) {
    throw InputError(fmt::format("warm_start: is not for the optimizer {}", options.optimizer));
  }
  if (options.refine && options.alpha) {
    throw InputError("refine: does not go with alpha, it has a gain of its own");
  }
  return options;
}

SceneFile read_scene(const Request& request) {
  // The name under which the page saves it.
  SceneFile file = make_scene_file("scene.json", parse_whole_scene(request.body, "scene.json"));
  file.problem.stop = request.turn.token();
  return file;
}

double work_of(const Backend& backend) {
  return static_cast<double>(backend.steps()) *
         static_cast<double>(backend.problem().cloth().particles());
}

void require_quick(const SceneFile& file, const Backend& backend, const Options& options) {
  const double particles = static_cast<double>(file.problem.cloth().particles());
  if (work_of(backend) > most_particle_steps(backend)) {
    throw InputError(
        fmt::format("{}: /{}: {} particles are not few enough for the studio: with {} steps on {}, "
                    "this is for nuno optimize",
                    file.path, file.mesh() ? "initial" : "particles", particles, backend.steps(),
                    backend.name()));
  }
  if (options.refine) require_refinable(file);
  if (options.after > most_flights_after * file.scene.arrival_time) {
    throw InputError(fmt::format("after: {} is not <= {}, {} arrival times", options.after,
                                 most_flights_after * file.scene.arrival_time, most_flights_after));
  }
  const double flight = 1 + options.after / file.scene.arrival_time;
  if (static_cast<double>(options.frames) * flight * particles > most_points_in_frames) {
    throw InputError(fmt::format("frames: {} is not <= {}", options.frames,
                                 std::floor(most_points_in_frames / particles / flight)));
  }
}

void require_few_frames_in_file(const SceneFile& file) {
  const double most = frames_per_second_of(most_points_in_frames, file);
  if (file.scene.frames_per_second > most) {
    throw InputError(
        fmt::format("{}: /frames_per_second: {} is not <= {:.4g}, the most that the studio makes a "
                    "file of with {} particles over {} s",
                    file.path, file.scene.frames_per_second, most, file.problem.cloth().particles(),
                    file.scene.arrival_time));
  }
}

}  // namespace nuno::studio
