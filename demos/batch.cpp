// nuno batch: many scenes, a result of each.

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>

#include <nuno/batch.h>
#include <nuno/conditioning.h>
#include <nuno/engines.h>
#include <nuno/input.h>
#include <nuno/output.h>
#include <nuno/result_file.h>
#include <nuno/search.h>
#include "batch_summary.h"
#include "commands.h"
#include "scene_paths.h"

namespace nuno {
namespace {

namespace fs = std::filesystem;
using State = Shot::State;

/// Every shot with the file of its result, which is no other's and no shot.
std::vector<Shot> list_shots(const BatchOptions& options) {
  std::vector<Shot> shots;
  std::map<std::string, std::string> taken;
  for (const std::string& path : scene_paths(options.shots)) {
    const std::string result = (fs::path(options.out) / fs::path(path).stem()).string() + ".json";
    const auto [other, is_free] = taken.emplace(result, path);
    if (!is_free) {
      throw InputError(fmt::format("{}: has the name of {}: their results would be one file", path,
                                   other->second));
    }
    std::error_code error;
    if (fs::equivalent(path, result, error)) {
      throw InputError(fmt::format("--out: {} is the folder of {}: the result would take its place",
                                   options.out, path));
    }
    shots.push_back({path, result});
  }
  return shots;
}

/// The files that a scene is read from.
std::vector<fs::path> inputs_of(const std::string& scene) {
  std::vector<fs::path> files = {scene};
  const auto json = nlohmann::json::parse(read_input(scene), nullptr, false);
  for (const char* shape : {"initial", "target"}) {
    if (!json.is_object() || !json.contains(shape) || !json[shape].is_string()) continue;
    const std::string mesh = mesh_file(json[shape].get<std::string>());
    files.push_back(fs::path(scene).parent_path() / mesh);
  }
  return files;
}

/// Whether a run before has made the result of the scene as it is now.
bool is_made(const Shot& shot, const std::string& backend) {
  std::error_code error;
  const auto made = fs::last_write_time(shot.result, error);
  if (error) return false;
  for (const fs::path& input : inputs_of(shot.scene)) {
    if (!(fs::last_write_time(input, error) <= made) || error) return false;
  }
  return is_result(shot.result, backend);
}

using Finish = std::function<void()>;

Finish ends(Shot& shot, State state, const std::string& reason = {}) {
  return [&shot, state, reason] {
    shot.state = state;
    shot.reason = reason;
    if (!reason.empty()) complain(reason);
  };
}

/// The throw that `nuno optimize` makes of the scene; what is returned writes it.
Finish thrown(Shot& shot, const std::string& engine, const std::stop_token& stop) {
  SceneFile file = read_scene_file(shot.scene);
  file.problem.stop = stop;
  require_few_frames(file);
  const SearchAnswer answer = search(file, make_backend(engine, file), {});
  const JudgedRollout flown = judged_rollout(*answer.backend, file, answer.gains,
                                             {.frames_per_second = file.scene.frames_per_second});
  const Backend& backend = flown.finer ? *flown.finer : *answer.backend;
  if (diverged(flown.flight)) {
    return ends(shot, State::diverged, divergence_message(file.path, backend, flown.flight));
  }
  // As text already: only what waits for the disk is left to the one thread that writes.
  std::string text = written_text([&](std::FILE* result) {
    write_result(result, file.input, backend, flown.flight, flown.sensitivity, answer.how);
  });
  return [&shot, text = std::move(text)] {
    try {
      write_output(shot.result, text);
      shot.state = State::thrown;
    } catch (const OutputError& error) {
      ends(shot, State::unwritten, error.what())();
    }
  };
}

Finish work_on(Shot& shot, const std::string& engine, const std::stop_token& stop) {
  try {
    return is_made(shot, engine) ? ends(shot, State::kept) : thrown(shot, engine, stop);
  } catch (const InputError& error) {
    return ends(shot, State::broken, error.what());
  } catch (const std::bad_alloc&) {
    return ends(shot, State::broken, shot.scene + ": needs more memory than there is");
  }
}

Index count_of(const std::vector<Shot>& shots, State state) {
  return std::ranges::count(shots, state, &Shot::state);
}

std::string counts(const std::vector<Shot>& shots) {
  std::string text =
      fmt::format("{} shots: {} thrown", shots.size(), count_of(shots, State::thrown));
  for (const auto& [state, word] :
       {std::pair(State::kept, "were there"), std::pair(State::diverged, "diverged"),
        std::pair(State::broken, "broken"), std::pair(State::unwritten, "could not be written")}) {
    if (const Index count = count_of(shots, state)) text += fmt::format(", {} {}", count, word);
  }
  return text;
}

}  // namespace

ExitStatus throw_batch(const BatchOptions& options) {
  std::vector<Shot> shots = list_shots(options);
  if (options.parts > 1) {
    std::vector<Shot> part;
    for (auto i = static_cast<std::size_t>(options.part - 1); i < shots.size();
         i += static_cast<std::size_t>(options.parts)) {
      part.push_back(shots[i]);
    }
    shots = std::move(part);
  }
  create_folder(options.out);
  const Index cores = std::max(1u, std::thread::hardware_concurrency());
  const Index jobs = options.jobs > 0 ? options.jobs : cores;
  run_batch(std::ssize(shots), jobs, [&](Index i, const std::stop_token& stop) -> Finish {
    const Finish finish = work_on(shots[static_cast<std::size_t>(i)], options.backend, stop);
    return [&, finish] {
      finish();
      show_progress(counts(shots));
    };
  });
  clear_progress();
  fmt::print("{}\n", counts(shots));
  if (options.parts == 1) write_batch_summary(options.out, shots, jobs);
  return count_of(shots, State::unwritten)  ? ExitStatus::unwritable
         : count_of(shots, State::broken)   ? ExitStatus::bad_input
         : count_of(shots, State::diverged) ? ExitStatus::diverged
                                            : ExitStatus::done;
}

}  // namespace nuno
