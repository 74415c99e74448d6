#include <nuno/crossings.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <tuple>
#include <utility>

namespace nuno {
namespace {

using Vec3 = Eigen::Vector3d;
using Box = Eigen::AlignedBox3d;

struct Triangle {
  std::array<Index, 3> corners;
  Index face = 0;
};

std::vector<Triangle> triangles_of(const Faces& faces) {
  std::vector<Triangle> triangles;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    for (std::size_t k = 2; k < faces[f].size(); ++k) {
      triangles.push_back({{faces[f][0], faces[f][k - 1], faces[f][k]}, static_cast<Index>(f)});
    }
  }
  return triangles;
}

bool share_a_corner(const Triangle& a, const Triangle& b) {
  return std::ranges::any_of(
      a.corners, [&](Index i) { return std::ranges::find(b.corners, i) != b.corners.end(); });
}

/// A box around each of a set of things, halved again and again: pairs whose boxes meet are found
/// without looking at most of the others.
class BoxTree {
 public:
  explicit BoxTree(std::vector<Box> boxes) : boxes_(std::move(boxes)), order_(boxes_.size()) {
    std::iota(order_.begin(), order_.end(), std::size_t{0});
    if (!order_.empty()) root_ = build(0, order_.size());
  }

  /// Calls `see(i, j)` once for each pair of things whose boxes meet.
  template <typename See>
  void for_each_pair(const See& see) const {
    if (!nodes_.empty()) pairs_within(root_, see);
  }

 private:
  static constexpr std::size_t leaf_size = 4, none = static_cast<std::size_t>(-1);
  struct Node {
    Box box;
    std::size_t first = 0, last = 0;        ///< of order_
    std::size_t left = none, right = none;  ///< a leaf has none
  };

  std::size_t build(std::size_t first, std::size_t last) {
    Node node;
    node.first = first;
    node.last = last;
    for (std::size_t i = first; i < last; ++i) node.box.extend(boxes_[order_[i]]);
    if (last - first > leaf_size) {
      Index axis = 0;
      node.box.sizes().maxCoeff(&axis);
      const std::size_t middle = first + (last - first) / 2;
      const auto at = [&](std::size_t i) {
        return order_.begin() + static_cast<std::ptrdiff_t>(i);
      };
      std::nth_element(at(first), at(middle), at(last), [&](std::size_t a, std::size_t b) {
        return boxes_[a].center()[axis] < boxes_[b].center()[axis];
      });
      node.left = build(first, middle);
      node.right = build(middle, last);
    }
    nodes_.push_back(node);
    return nodes_.size() - 1;
  }

  template <typename See>
  void pairs_within(std::size_t n, const See& see) const {
    const Node& node = nodes_[n];
    if (node.left == none) {
      for (std::size_t i = node.first; i < node.last; ++i) {
        for (std::size_t j = i + 1; j < node.last; ++j) see_if_near(order_[i], order_[j], see);
      }
      return;
    }
    pairs_within(node.left, see);
    pairs_within(node.right, see);
    pairs_between(node.left, node.right, see);
  }

  template <typename See>
  void pairs_between(std::size_t m, std::size_t n, const See& see) const {
    const Node &a = nodes_[m], &b = nodes_[n];
    if (!a.box.intersects(b.box)) return;
    if (a.left != none) {
      pairs_between(a.left, n, see);
      pairs_between(a.right, n, see);
    } else if (b.left != none) {
      pairs_between(m, b.left, see);
      pairs_between(m, b.right, see);
    } else {
      for (std::size_t i = a.first; i < a.last; ++i) {
        for (std::size_t j = b.first; j < b.last; ++j) see_if_near(order_[i], order_[j], see);
      }
    }
  }

  template <typename See>
  void see_if_near(std::size_t i, std::size_t j, const See& see) const {
    if (boxes_[i].intersects(boxes_[j])) see(std::min(i, j), std::max(i, j));
  }

  std::vector<Box> boxes_;
  std::vector<std::size_t> order_;
  std::vector<Node> nodes_;
  std::size_t root_ = 0;
};

using Corners = std::array<Vec3, 3>;

/// How deep the segment from p to q pierces the triangle; 0 where it does not.
///
/// It does where its ends are on different sides of the plane, and the three volumes that the line
/// spans with the triangle's edges have one sign (Möller and Trumbore 1997, without the division).
double piercing_depth(const Vec3& p, const Vec3& q, const Corners& t) {
  const Vec3 normal = (t[1] - t[0]).cross(t[2] - t[0]);
  const double at_p = normal.dot(p - t[0]), at_q = normal.dot(q - t[0]);
  if (!((at_p > 0 && at_q < 0) || (at_p < 0 && at_q > 0))) return 0;
  const Vec3 along = q - p;
  std::array<double, 3> volume;
  for (std::size_t k = 0; k < 3; ++k) {
    volume[k] = along.dot((t[k] - p).cross(t[(k + 1) % 3] - p));
  }
  const bool inside = std::ranges::all_of(volume, [](double v) { return v > 0; }) ||
                      std::ranges::all_of(volume, [](double v) { return v < 0; });
  return inside ? std::min(std::abs(at_p), std::abs(at_q)) / normal.norm() : 0;
}

/// How deep edges of `a` pierce `b`, at most; 0 where none does.
double reach(const Corners& a, const Corners& b) {
  double depth = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    depth = std::max(depth, piercing_depth(a[k], a[(k + 1) % 3], b));
  }
  return depth;
}

double crossing_depth(const Corners& a, const Corners& b) {
  const double one = reach(a, b), other = reach(b, a);
  return one > 0 && other > 0 ? std::min(one, other) : std::max(one, other);
}

std::vector<Index> faces_of(const std::vector<Crossing>& found) {
  std::set<Index> faces;
  for (const Crossing& crossing : found) faces.insert(crossing.faces.begin(), crossing.faces.end());
  return {faces.begin(), faces.end()};
}

}  // namespace

std::vector<Crossing> crossings(const Points& shape, const Faces& faces) {
  const std::vector<Triangle> triangles = triangles_of(faces);
  const auto corners = [&](std::size_t i) {
    const auto& [a, b, c] = triangles[i].corners;
    return Corners{shape.col(a), shape.col(b), shape.col(c)};
  };
  std::vector<Box> boxes;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    Box& box = boxes.emplace_back();
    for (const Vec3& corner : corners(i)) box.extend(corner);
  }
  std::vector<Crossing> found;
  BoxTree(std::move(boxes)).for_each_pair([&](std::size_t i, std::size_t j) {
    if (share_a_corner(triangles[i], triangles[j])) return;
    const double depth = crossing_depth(corners(i), corners(j));
    if (depth > 0) found.push_back({{triangles[i].face, triangles[j].face}, depth});
  });
  std::ranges::sort(found, {}, &Crossing::faces);  // whatever way the tree was gone through
  return found;
}

FlightCrossings flight_crossings(const std::vector<double>& times,
                                 const std::vector<Points>& positions, const Faces& faces,
                                 double ground) {
  FlightCrossings told;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    ++told.frames;
    const std::vector<Crossing> found = crossings(positions[i], faces);
    told.crossed_faces.push_back(faces_of(found));
    if (!found.empty()) {
      if (told.crossed_frames++ == 0) told.first_time = times[i];
      told.most_pairs = std::max(told.most_pairs, static_cast<Index>(found.size()));
      const double depth = std::ranges::max(found, {}, &Crossing::depth).depth;
      if (depth > told.depth) std::tie(told.depth, told.deepest_time) = std::pair(depth, times[i]);
    }
    const double below = ground - positions[i].row(1).minCoeff();
    if (below > 0) {
      if (told.grounded_frames++ == 0) told.ground_time = times[i];
      told.ground_depth = std::max(told.ground_depth, below);
    }
  }
  return told;
}

FlightCrossings flight_crossings(const Problem& problem, const std::vector<double>& times,
                                 const std::vector<Points>& positions) {
  return flight_crossings(times, positions, problem.sheet().faces,
                          ground_height(problem.cloth().initial, problem.target));
}

double ground_height(const Points& initial, const Points& target) {
  return std::min({0.0, initial.row(1).minCoeff(), target.row(1).minCoeff()});
}

}  // namespace nuno
