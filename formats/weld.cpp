#include <nuno/mesh.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>
#include <span>
#include <tuple>
#include <utility>

namespace nuno {
namespace {

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

/// The number of each vertex's place, the same for vertices at one place in every pose.
std::vector<Index> places(std::span<const Points* const> poses) {
  const Index count = poses.front()->cols();
  const auto order = [&](Index a, Index b) {
    for (const Points* pose : poses) {
      for (Index row = 0; row < pose->rows(); ++row) {
        if ((*pose)(row, a) != (*pose)(row, b)) return (*pose)(row, a) < (*pose)(row, b) ? -1 : 1;
      }
    }
    return 0;
  };
  std::vector<Index> sorted(at(count)), place(at(count));
  std::iota(sorted.begin(), sorted.end(), Index{0});
  std::ranges::sort(sorted, [&](Index a, Index b) { return order(a, b) < 0; });
  for (std::size_t i = 1; i < sorted.size(); ++i) {
    place[at(sorted[i])] =
        place[at(sorted[i - 1])] + (order(sorted[i - 1], sorted[i]) != 0 ? 1 : 0);
  }
  return place;
}

/// A face's side, from one of its corners to the next: the places of its ends in ascending order.
struct Side {
  std::array<std::int32_t, 2> places;
  std::int32_t face, corner;
};

/// The side's ends, in the order of their places.
std::array<Index, 2> ends(const Side& side, const Faces& faces, const std::vector<Index>& place) {
  const auto& face = faces[at(side.face)];
  std::array both = {face[at(side.corner)], face[(at(side.corner) + 1) % face.size()]};
  if (place[at(both[0])] > place[at(both[1])]) std::swap(both[0], both[1]);
  return both;
}

std::vector<Side> sides_of(const Faces& faces, const std::vector<Index>& place) {
  std::size_t count = 0;
  for (const auto& face : faces) count += face.size();
  std::vector<Side> sides;
  sides.reserve(count);
  for (std::size_t f = 0; f < faces.size(); ++f) {
    for (std::size_t k = 0; k < faces[f].size(); ++k) {
      Side side{{}, static_cast<std::int32_t>(f), static_cast<std::int32_t>(k)};
      const auto [first, last] = ends(side, faces, place);
      if (place[at(first)] == place[at(last)]) continue;  // has no length: refused as a sheet's
      side.places = {static_cast<std::int32_t>(place[at(first)]),
                     static_cast<std::int32_t>(place[at(last)])};
      sides.push_back(side);
    }
  }
  std::ranges::sort(
      sides, {}, [](const Side& side) { return std::tuple(side.places, side.face, side.corner); });
  return sides;
}

/// Sets of vertices, each under the least of its numbers.
class Sets {
 public:
  explicit Sets(Index count) : parent_(at(count)) {
    std::iota(parent_.begin(), parent_.end(), Index{0});
  }
  Index least(Index i) {
    while (parent_[at(i)] != i) i = parent_[at(i)] = parent_[at(parent_[at(i)])];
    return i;
  }
  void unite(Index a, Index b) {
    a = least(a);
    b = least(b);
    parent_[at(std::max(a, b))] = std::min(a, b);
  }

 private:
  std::vector<Index> parent_;
};

/// Whether every corner of the one lies on a corner of the other.
bool lies_upon(const std::vector<Index>& face, const std::vector<Index>& other,
               const std::vector<Index>& place) {
  return std::ranges::all_of(face, [&](Index corner) {
    return std::ranges::any_of(
        other, [&](Index vertex) { return place[at(vertex)] == place[at(corner)]; });
  });
}

/// Of each vertex of the file, its number after welding by these poses.
std::vector<Index> welded(const Faces& faces, std::span<const Points* const> poses) {
  const std::vector<Index> place = places(poses);
  const std::vector<Side> sides = sides_of(faces, place);
  const Index count = poses.front()->cols();
  Sets sets(count);
  for (std::size_t start = 0, end = 0; start < sides.size(); start = end) {
    const Side& one = sides[start];
    while (end < sides.size() && sides[end].places == one.places) ++end;
    if (end - start != 2) continue;
    const Side& other = sides[start + 1];
    const auto &face = faces[at(one.face)], &beside = faces[at(other.face)];
    if (lies_upon(face, beside, place) || lies_upon(beside, face, place)) continue;
    const auto here = ends(one, faces, place), there = ends(other, faces, place);
    sets.unite(here[0], there[0]);
    sets.unite(here[1], there[1]);
  }
  std::vector<Index> number(at(count));
  Index next = 0;
  for (Index i = 0; i < count; ++i) {
    const Index least = sets.least(i);
    number[at(i)] = least == i ? next++ : number[at(least)];
  }
  return number;
}

void renumber(Mesh& mesh, const std::vector<Index>& number) {
  const Index count = number.empty() ? 0 : 1 + *std::ranges::max_element(number);
  const auto in_file = std::ssize(number);
  if (count == in_file) return;
  for (Index i = 0; i < in_file; ++i)
    mesh.vertices.col(number[at(i)]) = mesh.vertices.col(i).eval();
  mesh.vertices.conservativeResize(3, count);
  for (auto& face : mesh.faces) {
    for (Index& vertex : face) vertex = number[at(vertex)];
  }
  mesh.file_vertices = number;
  mesh.remarks.push_back(
      fmt::format("{} of the file's {} vertices are copies at seams of texture, normals or "
                  "material, and are welded",
                  in_file - count, in_file));
}

}  // namespace

void weld_seams(Mesh& mesh, Mesh& pose) {
  if (mesh.splits_seams && pose.splits_seams && mesh.faces == pose.faces &&
      mesh.vertices.cols() == pose.vertices.cols()) {
    const std::array both = {&std::as_const(mesh.vertices), &std::as_const(pose.vertices)};
    const std::vector<Index> number = welded(mesh.faces, both);
    renumber(mesh, number);
    renumber(pose, number);
    return;
  }
  for (Mesh* each : {&mesh, &pose}) {
    const std::array alone = {&std::as_const(each->vertices)};
    if (each->splits_seams) renumber(*each, welded(each->faces, alone));
  }
}

}  // namespace nuno
