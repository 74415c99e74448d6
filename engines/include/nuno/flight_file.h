#pragma once

#include <nuno/engines.h>
#include <nuno/result_file.h>

#include <optional>
#include <string>

namespace nuno {

/// How a flight lies in the shot, for a file that holds an animation.
struct AnimationOptions {
  Index first_frame = 1;  ///< number of the first frame, ≥ 0
  Index held_frames = 0;  ///< of the initial shape before the throw, ≥ 0
  double tail = 0;        ///< flight after arrival, without control [s], ≥ 0
  std::optional<double>
      ribbon_width;  ///< of a chain's mesh [m], > 0; absent: a tenth of its length
};

/// Throws InputError or OutputError, before any work is done, where a flight of this scene would
/// not have room for its frames, in memory and at `out` (none if that is empty), or the kind of
/// file does not hold what is asked.
void require_room(const SceneFile& file, const std::string& out, const AnimationOptions& animation);

/// Writes a flight, which has not diverged and has its frames, to `out`: as an animated mesh where
/// its name says so, else as a result file. Throws OutputError.
void write_flight(const std::string& out, const SceneFile& file, const Backend& backend,
                  const Rollout& flight, double sensitivity, const AnimationOptions& animation,
                  const std::optional<Optimization>& optimization);

}  // namespace nuno
