#pragma once

#include <nuno/scene.h>

#include <array>
#include <string>
#include <vector>

namespace nuno {

/// A mesh as its file gives it.
struct Mesh {
  Points vertices;             ///< [3 × N], m
  Faces faces;                 ///< each of at least 3 corners
  Points texture_coordinates;  ///< [2 × any]; without columns where the file has none
  /// Of each face's corners, their columns in texture_coordinates; empty where the file has none.
  Faces texture_corners;
  // Lines of the file, for messages.
  std::vector<Index> lines;         ///< on which each face stands
  std::vector<Index> vertex_lines;  ///< on which each vertex stands
};

/// Reads a mesh by its file's extension (.obj). Throws InputError with file, line, value and rule.
Mesh read_mesh(const std::string& path);

/// Reads Wavefront OBJ: v, vt and f, with any of the forms of an index, from the front or the back.
/// Groups, materials, normals and the like are passed over; objects of a file are one mesh.
/// `source` names the text in messages.
Mesh parse_obj(const std::string& text, const std::string& source);

/// Cuts every face of more than 4 corners into triangles, as its shape asks for.
void cut_polygons(Mesh& mesh);

/// A polygon of points [3 × n] cut into triangles by its ears (Meisters 1975), so that one that is
/// not convex is cut right: three columns each.
std::vector<std::array<Index, 3>> triangulated(const Points& polygon);

/// Throws InputError, with file and line, for a mesh whose faces are no sheet at rest (see
/// scene.h).
void require_sheet(const Mesh& mesh, const std::string& path);

/// The same for a pose of it, of which only the vertices count.
void require_pose(const Mesh& pose, const std::string& path);

/// Throws InputError unless both meshes have the same faces, so that the one is a pose of the
/// other; the paths name them in the message.
void require_same_faces(const Mesh& mesh, const std::string& path, const Mesh& pose,
                        const std::string& pose_path);

}  // namespace nuno
