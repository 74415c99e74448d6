#pragma once

#include <nuno/mesh.h>

#include <array>
#include <cstdio>
#include <string>
#include <string_view>
#include <vector>

namespace nuno {

/// A mesh in motion, as animation packages keep one: frames of whole numbers at an even rate.
struct Animation {
  std::string name;
  Mesh mesh;  ///< its vertices are not used: those of the frames take their place
  double frames_per_second = 24;  ///< [1/s], > 0
  Index first_frame = 1;          ///< number of the first frame, ≥ 0
  std::vector<double> times;      ///< of the frames [s], ascending, from 0
  std::vector<Points> positions;  ///< of the frames, at least one [3 × N each], m
};

/// How a file is told to hold an animation: the end of its name.
///  - .glb: binary glTF, morph targets and their weights, see glb_file.h;
///  - .pc2, .mdd: point caches, the vertices of every frame in the order of the mesh's file;
///  - .usda: USD, a mesh whose points have time samples;
///  - .obj: a file for each frame; a run of # in the name is the frame's number.
inline constexpr std::array<std::string_view, 5> animation_extensions = {".glb", ".pc2", ".mdd",
                                                                         ".usda", ".obj"};

/// Whether a file of this name holds an animation.
bool is_animation(std::string_view path);

/// Throws InputError where files of this name cannot hold such an animation: frames that do not end
/// at `arrival_time` [s], in those that number their frames; no # in the name of numbered files.
void require_animation(const std::string& path, double arrival_time, double frames_per_second);

/// Writes the file of one of animation_extensions but .obj, which takes several.
void write_animation(std::FILE* file, std::string_view extension, const Animation& animation);

/// Writes the file or files, each whole or not at all. Throws OutputError.
void write_animation(const std::string& path, const Animation& animation);

/// How wide such a ribbon is where nobody says it, of a chain of this length [m].
inline double ribbon_width(double length) { return length / 10; }

/// A chain's shape [2 × N] as a ribbon of `width` [m] along z: vertices [3 × 2N], first those at
/// one border.
Points ribbon(const Points& shape, double width);

/// The mesh of such a ribbon along this shape: quads, u along the chain and v across.
Mesh ribbon_mesh(const Points& shape, double width);

}  // namespace nuno
