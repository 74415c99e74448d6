#include <nuno/sheet.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <map>
#include <utility>

namespace nuno {
namespace {

using Eigen::Vector3d;

double triangle_area(const Points& x, Index a, Index b, Index c) {
  const Vector3d p = x.col(a);
  return 0.5 * (x.col(b) - p).head<3>().cross((x.col(c) - p).head<3>()).norm();
}

double face_area(const Points& x, const std::vector<Index>& face) {
  const double one = triangle_area(x, face[0], face[1], face[2]);
  if (face.size() == 3) return one;
  return 0.5 * (one + triangle_area(x, face[0], face[2], face[3]) +
                triangle_area(x, face[1], face[2], face[3]) +
                triangle_area(x, face[1], face[3], face[0]));
}

/// A face's corner at an edge: `start` → `end` as the face runs, then the corner after and the one
/// before; the same one in a triangle.
struct Side {
  Index start, end, after_end, before_start;
  std::size_t corners;
};

/// An edge with the faces beside it.
struct EdgeSides {
  std::vector<Side> sides;
  double area = 0;  ///< whole triangles and half quads beside it
};

class Builder {
 public:
  Builder(const Points& initial, const Faces& faces, const SheetMaterial& material, Rest rest)
      : x_(initial), faces_(faces), material_(material), rest_(rest) {}

  Sheet build(double gravity) {
    sheet_.initial = x_;
    sheet_.faces = faces_;
    sheet_.material = material_;
    sheet_.gravity = gravity;
    add_masses();
    add_triangles();
    find_edges();
    add_stretch();
    add_shear();
    add_hinges();
    return std::move(sheet_);
  }

 private:
  double length(Index a, Index b) const { return (x_.col(a) - x_.col(b)).norm(); }

  void add_masses() {
    const Index n = x_.cols();
    Vector area = Vector::Zero(n);
    double total = 0;
    for (const auto& face : faces_) {
      const double of_face = face_area(x_, face);
      total += of_face;
      for (const Index i : face) area[i] += of_face / static_cast<double>(face.size());
    }
    sheet_.relative_mass = area / area.mean();
    sheet_.particle_mass = material_.areal_density * total / static_cast<double>(n);
    sheet_.drag_rate = material_.air_drag / material_.areal_density;
    sheet_.size = std::sqrt(total);
    sheet_.sound_speed = std::sqrt(material_.stretch_stiffness / material_.areal_density);
  }

  void add_triangles() {
    std::vector<std::array<Index, 3>> triangles;
    std::vector<double> weights;
    for (const auto& f : faces_) {
      const bool quad = f.size() == 4;
      triangles.push_back({f[0], f[1], f[2]});
      if (quad) {
        triangles.push_back({f[0], f[2], f[3]});
        triangles.push_back({f[1], f[2], f[3]});
        triangles.push_back({f[1], f[3], f[0]});
      }
      weights.resize(triangles.size(), quad ? 0.5 : 1.0);
    }
    sheet_.triangles.resize(3, static_cast<Index>(triangles.size()));
    sheet_.triangle_weight.resize(sheet_.triangles.cols());
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      const auto at = static_cast<Index>(t);
      sheet_.triangles.col(at) << triangles[t][0], triangles[t][1], triangles[t][2];
      sheet_.triangle_weight[at] = weights[t];
    }
  }

  void find_edges() {
    std::map<std::pair<Index, Index>, std::size_t> known;
    for (const auto& face : faces_) {
      const std::size_t n = face.size();
      const double share = face_area(x_, face) * (n == 4 ? 0.5 : 1.0);
      for (std::size_t i = 0; i < n; ++i) {
        const Index a = face[i], b = face[(i + 1) % n];
        const auto [at, is_new] = known.try_emplace(std::minmax(a, b), sides_.size());
        if (is_new) {
          sides_.emplace_back();
          ends_.emplace_back(a, b);
        }
        EdgeSides& edge = sides_[at->second];
        edge.area += share;
        edge.sides.push_back({a, b, face[(i + 2) % n], face[(i + n - 1) % n], n});
      }
    }
  }

  void add_stretch() {
    const auto count = static_cast<Index>(ends_.size());
    Springs& springs = sheet_.stretch;
    resize(springs, count);
    for (Index e = 0; e < count; ++e) {
      const auto [a, b] = ends_[static_cast<std::size_t>(e)];
      const double l = length(a, b);
      const double shape = sides_[static_cast<std::size_t>(e)].area / (l * l);
      springs.ends.col(e) << a, b;
      springs.rest_length[e] = l;
      springs.stiffness[e] = material_.stretch_stiffness * shape;
      springs.damping[e] = material_.stretch_damping * shape;
    }
    sheet_.edges = springs.ends;
    sheet_.rest_length = springs.rest_length;
  }

  void add_shear() {
    Index quads = 0;
    for (const auto& face : faces_) quads += face.size() == 4 ? 1 : 0;
    Springs& springs = sheet_.shear;
    resize(springs, 2 * quads);
    Index at = 0;
    for (const auto& face : faces_) {
      if (face.size() != 4) continue;
      for (std::size_t i = 0; i < 2; ++i) {
        const double l = length(face[i], face[i + 2]);
        const double shape = face_area(x_, face) / (l * l);
        springs.ends.col(at) << face[i], face[i + 2];
        springs.rest_length[at] = l;
        springs.stiffness[at] = material_.shear_stiffness * shape;
        springs.damping[at] = material_.shear_damping * shape;
        ++at;
      }
    }
  }

  static void resize(Springs& springs, Index count) {
    springs.ends.resize(2, count);
    springs.rest_length.resize(count);
    springs.stiffness.resize(count);
    springs.damping.resize(count);
  }

  // On a square grid bent about any axis the hinges of the edges tell the curvatures along the
  // grid, κ_xx and κ_yy, and those of the diagonals the twist, κ_xy. A quarter of the law on either
  // diagonal makes the sum 3·B·(κ_xx² + κ_yy² + 2κ_xy²), the same about every axis.
  static constexpr double diagonal_weight = 0.25;

  void add_hinges() {
    for (const EdgeSides& edge : sides_) {
      if (edge.sides.size() != 2) continue;
      const Side& one = edge.sides[0];
      Side two = edge.sides[1];
      const bool opposed = one.start == two.end;
      // A face that runs the other way round still has the same corners at either end.
      const Index two_at_start = opposed ? two.after_end : two.before_start;
      const Index two_at_end = opposed ? two.before_start : two.after_end;
      if (one.corners == 3 && two.corners == 3) {
        add_hinge(one.start, one.end, one.after_end, two.after_end, 1);
      } else {  // the corners at either end face each other
        add_hinge(one.start, one.end, one.before_start, two_at_start, 0.5);
        add_hinge(one.start, one.end, one.after_end, two_at_end, 0.5);
      }
    }
    for (const auto& f : faces_) {
      if (f.size() != 4) continue;
      add_hinge(f[0], f[2], f[3], f[1], diagonal_weight);
      add_hinge(f[1], f[3], f[0], f[2], diagonal_weight);
    }
    Hinges& hinges = sheet_.hinges;
    const auto count = static_cast<Index>(hinges_.size());
    hinges.corners.resize(4, count);
    hinges.rest_angle.resize(count);
    hinges.stiffness.resize(count);
    hinges.damping.resize(count);
    for (Index h = 0; h < count; ++h) {
      const Hinge& hinge = hinges_[static_cast<std::size_t>(h)];
      for (Index k = 0; k < 4; ++k)
        hinges.corners(k, h) = hinge.corners[static_cast<std::size_t>(k)];
      hinges.rest_angle[h] = rest_ == Rest::flat ? 0 : dihedral_angle(x_, hinges.corners.col(h));
      hinges.stiffness[h] = material_.bending_stiffness * hinge.shape;
      hinges.damping[h] = material_.bending_damping * hinge.shape;
    }
  }

  struct Hinge {
    std::array<Index, 4> corners;
    double shape;  ///< weight·3·|e|²/(A₀ + A₁)
  };

  void add_hinge(Index a, Index b, Index c, Index d, double weight) {
    const double area = triangle_area(x_, a, b, c) + triangle_area(x_, b, a, d);
    const double l = length(a, b);
    hinges_.push_back({{a, b, c, d}, weight * 3 * l * l / area});
  }

  const Points& x_;
  const Faces& faces_;
  const SheetMaterial& material_;
  Rest rest_;
  std::vector<std::pair<Index, Index>> ends_;  // of the edges, as the first face runs
  std::vector<EdgeSides> sides_;
  std::vector<Hinge> hinges_;
  Sheet sheet_;
};

}  // namespace

double dihedral_angle(const Points& x, const Eigen::Matrix<Index, 4, 1>& corners) {
  const Vector3d a = x.col(corners[0]), b = x.col(corners[1]);
  const Vector3d c = x.col(corners[2]), d = x.col(corners[3]);
  const Vector3d edge = b - a;
  const Vector3d one = edge.cross(c - a), two = (d - a).cross(edge);
  return std::atan2(one.cross(two).dot(edge) / edge.norm(), one.dot(two));
}

double area(const Points& x, const Faces& faces) {
  double sum = 0;
  for (const auto& face : faces) sum += face_area(x, face);
  return sum;
}

Sheet make_sheet(const Points& initial, const Faces& faces, const SheetMaterial& material,
                 Rest rest, double gravity) {
  return Builder(initial, faces, material, rest).build(gravity);
}

}  // namespace nuno
