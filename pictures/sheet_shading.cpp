#include "pictures/sheet_shading.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numeric>
#include <vector>

namespace nuno::figures {
namespace {

using Vec3 = Eigen::Vector3d;

struct Named {
  std::string_view name;
  Vec3 front, back;  ///< red, green and blue, 0 … 255
};

// Mid tones of the style sheet's colours, readable on light and on dark paper.
const std::array<Named, 6> colors = {{{"a", {0, 118, 182}, {84, 162, 206}},
                                      {"b", {222, 112, 20}, {232, 156, 92}},
                                      {"c", {20, 150, 118}, {90, 184, 160}},
                                      {"d", {170, 90, 150}, {198, 140, 184}},
                                      {"target", {176, 180, 188}, {196, 199, 206}},
                                      {"soft", {140, 144, 154}, {164, 168, 176}}}};

const Vec3 light = Vec3(0.35, 0.85, 0.45).normalized();  // to where it comes from
constexpr double ambient = 0.62, diffuse = 0.5;
constexpr double slant = 0.12;  // of a shadow, over the height of what throws it

std::string place(const Plot& plot, const Vec3& point) {
  const Points on_paper = seen(point);
  const Vec at = plot.at(on_paper(0, 0), on_paper(1, 0));
  return fmt::format("{:.1f} {:.1f}", at.x, at.y);
}

std::string path(const Plot& plot, const std::vector<Index>& face, const Points& pose) {
  std::string text;
  for (const Index i : face) {
    text += text.empty() ? 'M' : 'L';
    text += place(plot, pose.col(i));
  }
  text += 'Z';
  return text;
}

/// Of a face, its corners taken as a fan: the sum of the triangles' normals, twice their area long.
Vec3 normal_of(const std::vector<Index>& face, const Points& pose) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t k = 2; k < face.size(); ++k) {
    const Vec3 origin = pose.col(face[0]), to_one = pose.col(face[k - 1]),
               to_other = pose.col(face[k]);
    sum += (to_one - origin).cross(to_other - origin);
  }
  return sum;
}

std::string shade(const Named& color, const Vec3& normal) {
  const bool faces_us = normal.dot(to_the_eye()) >= 0;
  const double lit = std::abs(normal.dot(light));
  const Vec3 rgb =
      ((ambient + diffuse * lit) * (faces_us ? color.front : color.back)).cwiseMin(255);
  return fmt::format("#{:02x}{:02x}{:02x}", std::lround(rgb[0]), std::lround(rgb[1]),
                     std::lround(rgb[2]));
}

}  // namespace

std::string shaded(const Plot& plot, const Faces& faces, const Points& pose, const Paint& paint) {
  const auto* const color = std::ranges::find(colors, paint.color, &Named::name);
  const Eigen::RowVectorXd nearness = to_the_eye().transpose() * pose;
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    double near = 0;
    for (const Index i : faces[f]) near += nearness[i] / static_cast<double>(faces[f].size());
    order.emplace_back(near, f);
  }
  std::ranges::sort(order);
  // Faces of one colour in a row share an element. Their rims are painted too, against gaps.
  std::string elements = fmt::format(
      "<g opacity=\"{:.3g}\" stroke-width=\".7\" stroke-linejoin=\"round\">", paint.opacity);
  std::string last;
  for (const auto& [near, f] : order) {
    const std::string fill = shade(*color, normal_of(faces[f], pose).normalized());
    if (fill != last) {
      fmt::format_to(std::back_inserter(elements), "{}<path fill=\"{}\" stroke=\"{}\" d=\"",
                     last.empty() ? "" : "\"/>", fill, fill);
      last = fill;
    }
    elements += path(plot, faces[f], pose);
  }
  return elements + "\"/></g>\n";
}

Points shadow_of(const Points& pose, double ground) {
  Points shadow = pose;
  for (Index i = 0; i < pose.cols(); ++i) {
    const double height = pose(1, i) - ground;
    shadow.col(i) = Vec3(pose(0, i) - slant * height, ground, pose(2, i) - slant * height);
  }
  return shadow;
}

std::string soft_shadow(const Plot& plot, const Faces& faces, const Points& pose, double ground) {
  const Points shadow = shadow_of(pose, ground);
  std::string elements =
      "<filter id=\"soft\" x=\"-20%\" y=\"-60%\" width=\"140%\" height=\"220%\"><feGaussianBlur "
      "stdDeviation=\"5\"/></filter><path filter=\"url(#soft)\" fill=\"#000\" opacity=\".16\" d=\"";
  for (std::vector<Index> face : faces) {
    // All the same way round, so that two that lie on one another do not cancel.
    if (normal_of(face, shadow).y() < 0) std::ranges::reverse(face);
    elements += path(plot, face, shadow);
  }
  return elements + "\"/>\n";
}

}  // namespace nuno::figures
