#pragma once

#include <nuno/scene.h>

namespace nuno {

inline constexpr Index smallest_particles = 3;  ///< of any cloth
inline constexpr Index largest_particles = 1'000'000;

/// What keeps a mesh from being a sheet, and where.
struct MeshFault {
  enum class At { mesh, face, vertex };
  At at = At::mesh;
  Index number = 0;  ///< of the face or vertex, from 0 on
  std::string what;  ///< the value and the rule that it breaks
};

/// The first fault of a sheet's mesh at rest, see validate (scene.h). Messages number vertices from
/// `first_number` on.
std::optional<MeshFault> mesh_fault(const Points& vertices, const Faces& faces,
                                    Index first_number = 0);

/// The first fault of vertices alone: too few or too many, coordinates beyond those of a scene, or
/// no extent.
std::optional<MeshFault> vertex_fault(const Points& vertices);

}  // namespace nuno
