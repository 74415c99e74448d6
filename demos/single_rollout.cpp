#include "single_rollout.h"

#include <fmt/format.h>

#include <cmath>

#include <nuno/animation.h>
#include <nuno/conditioning.h>
#include <nuno/output.h>
#include <nuno/progress.h>
#include "pictures/summary.h"

namespace nuno {

namespace {

/// The flight as a mesh in motion: a sheet's own, a chain's ribbon.
Animation animate(const SceneFile& file, const Rollout& flight, const AnimationOptions& options) {
  const Cloth& cloth = file.problem.cloth();
  const Mesh* const mesh = file.mesh();
  const double width = options.ribbon_width.value_or(cloth.size / 10);
  const auto shape = [&](const Points& positions) {
    return mesh ? positions : ribbon(positions, width);
  };
  Animation animation{file.scene.name,
                      mesh ? *mesh : ribbon_mesh(cloth.initial, width),
                      file.scene.frames_per_second,
                      options.first_frame,
                      {},
                      {}};
  for (Index k = 0; k < options.held_frames; ++k) {
    animation.times.push_back(static_cast<double>(k) / animation.frames_per_second);
    animation.positions.push_back(shape(cloth.initial));
  }
  const double start = static_cast<double>(options.held_frames) / animation.frames_per_second;
  for (std::size_t k = 0; k < flight.frame_times.size(); ++k) {
    animation.times.push_back(start + flight.frame_times[k]);
    animation.positions.push_back(shape(flight.frame_positions[k]));
  }
  return animation;
}

void require_no_animation_options(const AnimationOptions& options) {
  const AnimationOptions defaults;
  const char* set = options.first_frame != defaults.first_frame   ? "--first-frame"
                    : options.held_frames != defaults.held_frames ? "--hold-frames"
                    : options.tail != defaults.tail               ? "--tail"
                    : options.ribbon_width                        ? "--ribbon-width"
                                                                  : nullptr;
  if (set) {
    throw InputError(fmt::format("{}: is for an animation: --out with {}", set,
                                 fmt::join(animation_extensions, ", ")));
  }
}

/// Tells people, before it is made, of a file that they may not expect to be so large.
void note_large_file(const SceneFile& file, double more, const std::string& out) {
  constexpr double large = 100e6;                        // bytes
  const double per_number = is_animation(out) ? 5 : 20;  // of a binary file, of text
  const double frames = file.scene.frames_per_second * (file.scene.arrival_time + more);
  const double bytes = per_number * frames * static_cast<double>(file.problem.target.size());
  if (bytes < large) return;
  note(fmt::format("{}: /frames_per_second: {} makes {:.0f} frames, a file of some {:.1g} GB",
                   file.path, file.scene.frames_per_second, frames, 1e-9 * bytes));
}

/// Tells people of a step that is not the one that they asked for.
void print_shorter_step(std::FILE* people, const SceneFile& file, const Backend& backend) {
  const std::optional<double>& asked = file.scene.time_step;
  if (!asked) return;
  const double enough = std::ceil(file.scene.arrival_time / *asked * (1 - 1e-12));
  if (static_cast<double>(backend.steps()) <= enough) return;
  fmt::print(people, "  {:<17} {}, not {}: {} needs shorter ones for this cloth and gain\n",
             "time step", duration(backend.time_step()), duration(*asked), backend.name());
}

}  // namespace

void require_room(const SceneFile& file, const std::string& out,
                  const AnimationOptions& animation) {
  if (is_animation(out)) {
    require_animation(out, file.scene.arrival_time, file.scene.frames_per_second);
    if (file.mesh() && animation.ribbon_width) {
      throw InputError(fmt::format("--ribbon-width: is for a chain, and {} is a sheet", file.path));
    }
  } else {
    require_no_animation_options(animation);
  }
  const double held = static_cast<double>(animation.held_frames) / file.scene.frames_per_second;
  if (!out.empty()) require_few_frames(file, held + animation.tail);
  require_writable(out);
  if (!out.empty()) note_large_file(file, held + animation.tail, out);
}

ExitStatus fly(const SceneFile& file, const Backend& backend, const Gains& gains,
               const std::string& out, const AnimationOptions& animation,
               const std::optional<Optimization>& optimization) {
  const LongWork told(backend, file.scene.name, 2);  // the flight, and the twin that judges it
  const double frames = out.empty() ? 0 : file.scene.frames_per_second;
  const Rollout flight =
      rollout(backend, gains, {.frames_per_second = frames, .tail = animation.tail});
  if (diverged(flight)) {
    report_divergence(file.path, backend, flight);
    return ExitStatus::diverged;
  }
  const double growth = bounded_sensitivity(backend, flight);
  if (!out.empty()) {
    if (is_animation(out)) {
      write_animation(out, animate(file, flight, animation));
    } else {
      write_output(out, [&](std::FILE* result) {
        write_result(result, file.input, backend, flight, growth, optimization);
      });
    }
  }
  print_summary(people(out), file.scene.name, backend, flight, growth);
  print_shorter_step(people(out), file, backend);
  if (const Mesh* const mesh = file.mesh()) {
    for (const std::string& remark : mesh->remarks) {
      fmt::print(people(out), "  {:<17} {}\n", "mesh", printable(remark));
    }
  }
  return ExitStatus::done;
}

}  // namespace nuno
