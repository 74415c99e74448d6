#pragma once

#include <nuno/scene.h>

#include <array>
#include <optional>
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
  // Lines of the file, for messages; empty where it has none.
  std::vector<Index> lines;         ///< on which each face stands
  std::vector<Index> vertex_lines;  ///< on which each vertex stands
  Index first_number = 0;           ///< that the file gives to its first vertex
  /// Whether a vertex of the file has a single texture point and normal, so that exporters write
  /// one on a seam several times.
  bool splits_seams = false;
  /// Of each vertex of the file, in its order, its column in `vertices`, once copies are welded;
  /// empty where no vertex has copies.
  std::vector<Index> file_vertices;
  std::vector<std::string> remarks;  ///< what people should know of how the file was read
};

/// The most that a file may hold: what a cloth of a million particles can need.
inline constexpr Index most_file_vertices = 6'000'000, most_file_faces = 2'000'000;

/// Reads a mesh by its file's extension: .obj, .ply, .gltf, .glb. FILE.glb#NAME is the mesh as its
/// morph target of that name has it, FILE.glb# as its only one has it. Throws InputError with file,
/// place, value and rule.
Mesh read_mesh(const std::string& path);

/// The same of the bytes of a file called `path`, of which no other file is read.
Mesh parse_mesh(const std::string& bytes, const std::string& path);

/// The file of such a path, without the morph target; whether files like it can have one.
std::string mesh_file(const std::string& path);
bool may_have_morph_targets(const std::string& path);

/// Reads Wavefront OBJ: v, vt and f, with any of the forms of an index, from the front or the back.
/// Groups, materials, normals and the like are passed over; objects of a file are one mesh.
/// `source` names the text in messages.
Mesh parse_obj(const std::string& text, const std::string& source);

/// Reads PLY: ascii and binary, of either byte order. The elements `vertex` (x, y, z; texture
/// coordinates s and t, u and v, or either with texture_ before it) and `face` (vertex_indices)
/// count, whatever else there is is passed over.
Mesh parse_ply(const std::string& text, const std::string& source);

/// Reads glTF 2.0: the first mesh of a .gltf or .glb, all its primitives joined, moved as its node
/// and those above say; the base shape, or with `target` that morph target on top of it (empty: the
/// only one). Weights, skins and animations are not applied; a mesh with a skin is refused.
Mesh read_gltf(const std::string& path, const std::optional<std::string>& target);
/// The same of the bytes of the file called `path`; those of its buffers are to be in it.
Mesh parse_gltf(const std::string& bytes, const std::string& path,
                const std::optional<std::string>& target);

/// Joins the copies that exporters write of vertices on seams of texture or normals, the same in
/// both poses, and remarks on it. Copies are at one place in both, and ends of an edge where just
/// two faces meet, neither upon the other: so parts that only touch stay apart. Where the files'
/// faces differ, each pose is welded by itself.
void weld_seams(Mesh& mesh, Mesh& pose);

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

/// A face for messages: the file and the face's line or number, and its corners' numbers there.
std::string face_place(const Mesh& mesh, const std::string& path, std::size_t face);
std::string numbers_in_file(const Mesh& mesh, std::vector<Index> face);

/// Throws InputError unless both meshes have the same faces, so that the one is a pose of the
/// other; the paths name them in the message. Which way round a face runs does not matter.
void require_same_faces(const Mesh& mesh, const std::string& path, const Mesh& pose,
                        const std::string& pose_path);

}  // namespace nuno
