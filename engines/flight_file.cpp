#include <nuno/flight_file.h>

#include <nuno/animation.h>
#include <nuno/output.h>

#include <fmt/format.h>

namespace nuno {
namespace {

/// The flight as a mesh in motion: a sheet's own, a chain's ribbon.
Animation animate(const SceneFile& file, const Rollout& flight, const AnimationOptions& options) {
  const Cloth& cloth = file.problem.cloth();
  const Mesh* const mesh = file.mesh();
  const double width = options.ribbon_width.value_or(ribbon_width(cloth.size));
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

void write_flight(const std::string& out, const SceneFile& file, const Backend& backend,
                  const Rollout& flight, double sensitivity, const AnimationOptions& animation,
                  const std::optional<Optimization>& optimization) {
  if (is_animation(out)) {
    write_animation(out, animate(file, flight, animation));
  } else {
    write_output(out, [&](std::FILE* result) {
      write_result(result, file.input, backend, flight, sensitivity, optimization);
    });
  }
}

}  // namespace nuno
