#pragma once

#include <nuno/animation.h>

#include <cstdio>

namespace nuno {

/// Point cache 2: little-endian; the samples are the frames, one after another.
void write_pc2(std::FILE* file, const Animation& animation);

/// LightWave's MDD: big-endian, with the time of each frame.
void write_mdd(std::FILE* file, const Animation& animation);

/// USD as text: a Mesh whose points have a time sample for each frame, in metres, y up.
void write_usda(std::FILE* file, const Animation& animation);

/// Wavefront OBJ of one shape [3 × N] of the mesh.
void write_obj(std::FILE* file, const std::string& name, const Mesh& mesh, const Points& shape);

}  // namespace nuno
