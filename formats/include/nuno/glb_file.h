#pragma once

#include <nuno/mesh.h>

#include <cstdio>
#include <string>
#include <vector>

namespace nuno {

/// Writes binary glTF 2.0: one mesh, a morph target for each frame and an animation of their
/// weights, each frame at its own time. y is up and lengths are in metres, as in glTF. Vertices
/// keep their numbers; behind them stand twins of those on a seam of the texture.
///  - times: of the frames [s], ascending;
///  - positions: of the frames, at least one [3 × N each], of the mesh's vertices, each in a face.
/// Faces of more than 3 corners are cut by their shape in the first frame. Throws OutputError where
/// the file would be larger than the format allows.
void write_glb(std::FILE* file, const std::string& name, const Mesh& mesh,
               const std::vector<double>& times, const std::vector<Points>& positions);

}  // namespace nuno
