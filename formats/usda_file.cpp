#include <fmt/format.h>

#include <string>

#include "animation_files.h"

namespace nuno {
namespace {

/// A name that USD takes for a prim: letters, digits and _, no digit first.
std::string prim_name(const std::string& name) {
  std::string result;
  for (const char c : name) {
    const bool digit = c >= '0' && c <= '9';
    const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
    if (result.empty() && digit) result += '_';
    result += digit || letter ? c : '_';
  }
  return result.empty() ? "cloth" : result;
}

void print_list(std::FILE* file, const char* declaration, const Faces& faces,
                std::string (*print)(const std::vector<Index>&)) {
  fmt::print(file, "        {} = [", declaration);
  const char* separator = "";
  for (const std::vector<Index>& face : faces) {
    fmt::print(file, "{}{}", separator, print(face));
    separator = ", ";
  }
  fmt::print(file, "]");
}

std::string corners(const std::vector<Index>& face) {
  return fmt::format("{}", fmt::join(face, ", "));
}

std::string size(const std::vector<Index>& face) { return fmt::format("{}", face.size()); }

void print_points(std::FILE* file, const Points& points) {
  fmt::print(file, "[");
  const char* separator = "";
  const Eigen::MatrixXf numbers = points.cast<float>();
  for (const auto& point : numbers.colwise()) {
    fmt::print(file, "{}({})", separator, fmt::join(point, ", "));
    separator = ", ";
  }
  fmt::print(file, "]");
}

/// A frame's number; between whole ones where its time is.
double time_code(const Animation& animation, double time) {
  return static_cast<double>(animation.first_frame) + time * animation.frames_per_second;
}

void print_extents(std::FILE* file, const Animation& animation) {
  fmt::print(file, "        float3[] extent.timeSamples = {{\n");
  for (std::size_t k = 0; k < animation.positions.size(); ++k) {
    const Points& shape = animation.positions[k];
    Points bounds(3, 2);
    bounds << shape.rowwise().minCoeff(), shape.rowwise().maxCoeff();
    fmt::print(file, "            {:.9g}: ", time_code(animation, animation.times[k]));
    print_points(file, bounds);
    fmt::print(file, ",\n");
  }
  fmt::print(file, "        }}\n");
}

}  // namespace

void write_usda(std::FILE* file, const Animation& animation) {
  const std::string name = prim_name(animation.name);
  const Mesh& mesh = animation.mesh;
  fmt::print(file,
             "#usda 1.0\n"
             "(\n"
             "    defaultPrim = \"{0}\"\n"
             "    metersPerUnit = 1\n"
             "    upAxis = \"Y\"\n"
             "    timeCodesPerSecond = {1:.9g}\n"
             "    framesPerSecond = {1:.9g}\n"
             "    startTimeCode = {2:.9g}\n"
             "    endTimeCode = {3:.9g}\n"
             ")\n\n"
             "def Xform \"{0}\"\n"
             "{{\n"
             "    def Mesh \"cloth\"\n"
             "    {{\n"
             "        uniform token subdivisionScheme = \"none\"\n"
             "        uniform bool doubleSided = true\n",
             name, animation.frames_per_second, time_code(animation, animation.times.front()),
             time_code(animation, animation.times.back()));
  print_list(file, "int[] faceVertexCounts", mesh.faces, size);
  fmt::print(file, "\n");
  print_list(file, "int[] faceVertexIndices", mesh.faces, corners);
  fmt::print(file, "\n");
  if (!mesh.texture_corners.empty()) {
    fmt::print(file, "        texCoord2f[] primvars:st = ");
    print_points(file, mesh.texture_coordinates);
    fmt::print(file, " (\n            interpolation = \"faceVarying\"\n        )\n");
    print_list(file, "int[] primvars:st:indices", mesh.texture_corners, corners);
    fmt::print(file, "\n");
  }
  print_extents(file, animation);
  fmt::print(file, "        point3f[] points.timeSamples = {{\n");
  for (std::size_t k = 0; k < animation.positions.size(); ++k) {
    fmt::print(file, "            {:.9g}: ", time_code(animation, animation.times[k]));
    print_points(file, animation.positions[k]);
    fmt::print(file, ",\n");
  }
  fmt::print(file, "        }}\n    }}\n}}\n");
}

}  // namespace nuno
