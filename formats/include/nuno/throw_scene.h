#pragma once

#include <nuno/scene_file.h>

#include <string>

namespace nuno {

/// What an animator asks of a throw: along a damped morph, to the target at its time.
struct ThrowRequest {
  double arrival_time = 0;        ///< t₀ [s], > 0
  std::string material;           ///< of a mesh, one of named_materials; empty: default values
  double frames_per_second = 24;  ///< of the animation [1/s], > 0
  bool settle = false;            ///< the cloth comes to rest on the target
};

/// The scene of a throw from files: of two meshes, the same faces in two poses, or of two curves,
/// see drawing.h. With an empty `target`, `start` is a mesh with one morph target, or a drawing
/// with two curves called "initial" and "target".
AnyScene throw_scene(const ThrowRequest& request, const std::string& start,
                     const std::string& target);

/// The same of points: with faces a sheet's vertices in two poses [3 × N], without them a chain's
/// drawn lines [2 × any]. `source` names the scene in messages.
AnyScene throw_scene(const ThrowRequest& request, const Shapes& shapes, const std::string& source);

/// What messages call the scene of such a throw.
std::string throw_source(const std::string& start, const std::string& target);

}  // namespace nuno
