#include "single_rollout.h"

#include <fmt/format.h>

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
  const double width = options.ribbon_width.value_or(ribbon_width(cloth.size));
  const auto shape = [&](const Points& positions) {
    return file.mesh ? positions : ribbon(positions, width);
  };
  Animation animation{file.scene.name,
                      file.mesh ? *file.mesh : ribbon_mesh(cloth.initial, width),
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

}  // namespace

void require_room(const SceneFile& file, const std::string& out,
                  const AnimationOptions& animation) {
  if (is_animation(out)) {
    require_animation(out, file.scene.arrival_time, file.scene.frames_per_second);
    if (file.mesh && animation.ribbon_width) {
      throw InputError(fmt::format("--ribbon-width: is for a chain, and {} is a sheet", file.path));
    }
  } else {
    require_no_animation_options(animation);
  }
  const double held = static_cast<double>(animation.held_frames) / file.scene.frames_per_second;
  if (!out.empty()) require_few_frames(file, held + animation.tail);
  require_writable(out);
}

ExitStatus fly(const SceneFile& file, const Backend& asked, const Gains& gains,
               const std::string& out, const AnimationOptions& animation,
               const std::optional<Optimization>& optimization) {
  // The flight, and those that judge it: its twin, and at half of its step.
  const LongWork told(asked, file.scene.name, 4);
  // A sheet's are looked at, for where it passes through itself.
  const bool keeps_frames = !out.empty() || file.problem.is_sheet();
  const double frames = keeps_frames ? file.scene.frames_per_second : 0;
  ResolvedRollout flown =
      resolved_rollout(asked, file, gains, {.frames_per_second = frames, .tail = animation.tail});
  Rollout& flight = flown.flight;
  if (diverged(flight)) {
    report_divergence(file.path, asked, flight);
    return ExitStatus::diverged;
  }
  const Backend& backend = flown.finer ? *flown.finer : asked;
  if (const auto half = at_finer_step(backend, file, 0.5)) {
    flight.step_error = step_error(*half, flight);
  }
  const double growth = bounded_sensitivity(backend, flight);
  if (!out.empty()) {
    if (is_animation(out)) {
      write_animation(out, animate(file, flight, animation));
    } else {
      write_output(out, [&](std::FILE* result) {
        write_result(result, file.scene.name, backend, flight, growth, optimization);
      });
    }
  }
  print_summary(people(out), file.scene.name, backend, flight, growth);
  if (flown.finer) {
    fmt::print(people(out), "  {:<17} it diverges in {} steps of {}\n", "shorter steps",
               asked.steps(), duration(asked.time_step()));
  }
  if (file.mesh) {
    for (const std::string& remark : file.mesh->remarks) {
      fmt::print(people(out), "  {:<17} {}\n", "mesh", printable(remark));
    }
  }
  return ExitStatus::done;
}

}  // namespace nuno
