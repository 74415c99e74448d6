#include <nuno/mesh.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
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

/// A face's side: the places of its ends in ascending order, then those ends themselves.
struct Side {
  Index first_place, last_place;
  Index first, last;
  std::size_t face;
};

std::vector<Side> sides_of(const Faces& faces, const std::vector<Index>& place) {
  std::vector<Side> sides;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    for (std::size_t k = 0; k < faces[f].size(); ++k) {
      Index first = faces[f][k], last = faces[f][(k + 1) % faces[f].size()];
      if (place[at(first)] == place[at(last)]) continue;  // has no length: refused as a sheet's
      if (place[at(first)] > place[at(last)]) std::swap(first, last);
      sides.push_back({place[at(first)], place[at(last)], first, last, f});
    }
  }
  std::ranges::sort(sides, {}, [](const Side& side) {
    return std::tuple(side.first_place, side.last_place, side.face);
  });
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
    while (end < sides.size() && sides[end].first_place == one.first_place &&
           sides[end].last_place == one.last_place) {
      ++end;
    }
    if (end - start != 2) continue;
    const Side& other = sides[start + 1];
    if (lies_upon(faces[one.face], faces[other.face], place) ||
        lies_upon(faces[other.face], faces[one.face], place)) {
      continue;
    }
    sets.unite(one.first, other.first);
    sets.unite(one.last, other.last);
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
