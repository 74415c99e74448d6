#include <nuno/sheet_morph.h>

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

namespace nuno {
namespace {

using Eigen::Matrix2d;
using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Frame = Eigen::Matrix<double, 3, 2>;
using Rotations = std::vector<Quaterniond>;
using SparseMatrix = Eigen::SparseMatrix<double>;
using Factor = Eigen::SimplicialLDLT<SparseMatrix>;

constexpr Index sample_count = 33;
constexpr double sample_step = 1.0 / static_cast<double>(sample_count - 1);

Quaterniond exponential(const Vector3d& vector) {
  const double angle = vector.norm();
  const double half_sinc = angle > 1e-8 ? std::sin(0.5 * angle) / angle : 0.5;
  Quaterniond q;
  q.w() = std::cos(0.5 * angle);
  q.vec() = half_sinc * vector;
  return q;
}

/// The rotation vector of at most half a turn.
Vector3d logarithm(const Quaterniond& q) {
  const double sine = q.vec().norm();
  if (sine < 1e-300) return Vector3d::Zero();
  const double half = q.w() < 0 ? std::atan2(-sine, -q.w()) : std::atan2(sine, q.w());
  return (2 * half / sine) * q.vec();
}

/// M = U·S with orthonormal columns U and a symmetric S ≥ 0.
struct Polar {
  Frame rotation;
  Matrix2d stretch;
};

// In two dimensions √C = (C + √|C|·1)/√(tr C + 2·√|C|), C = MᵀM.
Polar polar(const Frame& m) {
  const Matrix2d c = m.transpose() * m;
  const double root = std::sqrt(std::max(0.0, c.determinant()));
  if (root > 1e-10 * c.trace()) {
    const Matrix2d s = (c + root * Matrix2d::Identity()) / std::sqrt(c.trace() + 2 * root);
    return {m * s.inverse(), s};
  }
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(m, Eigen::ComputeThinU | Eigen::ComputeThinV);
  const Eigen::MatrixXd &u = svd.matrixU(), &v = svd.matrixV();
  return {u * v.transpose(), v * svd.singularValues().asDiagonal() * v.transpose()};
}

/// A triangle of the mesh: x ↦ ∇x [3 × 2] in the plane of its initial shape, and the way it goes.
struct Triangle {
  std::array<Index, 3> corners;
  Frame plane;                           ///< orthonormal axes of the initial triangle
  Eigen::Matrix<double, 2, 3> gradient;  ///< of the corners' hat functions, a column each
  double weight;                         ///< area·triangle_weight
  Matrix2d stretch;                      ///< S at the target

  Frame gradient_of(const Points& x) const {
    return x.col(corners[0]) * gradient.col(0).transpose() +
           x.col(corners[1]) * gradient.col(1).transpose() +
           x.col(corners[2]) * gradient.col(2).transpose();
  }
  Matrix2d stretch_at(double s) const { return (1 - s) * Matrix2d::Identity() + s * stretch; }
};

Matrix3d with_normal(const Frame& frame) {
  Matrix3d full;
  full << frame, frame.col(0).cross(frame.col(1));
  return full;
}

std::size_t triangles_in(const std::vector<Index>& face) { return face.size() == 4 ? 4 : 1; }

/// Two faces that share an edge.
struct Neighbours {
  std::size_t one, other;
  Vector3d turn;  ///< rotation vector of the other's way relative to the one's
};

/// Positions whose gradients are the nearest to given ones, by least squares: a Poisson equation
/// whose matrix Σ w·A·∇φᵢ·∇φⱼ, the cotangent Laplacian, is positive whatever the triangles' angles.
class Integrator {
 public:
  Integrator(const std::vector<Triangle>& triangles, Index vertices)
      : triangles_(triangles), vertices_(vertices) {
    std::vector<Eigen::Triplet<double>> entries;
    for (const Triangle& t : triangles) {
      for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
          if (t.corners[i] == 0 || t.corners[j] == 0) continue;  // vertex 0 stays at the origin
          const auto a = static_cast<Index>(i), b = static_cast<Index>(j);
          entries.emplace_back(t.corners[i] - 1, t.corners[j] - 1,
                               t.weight * t.gradient.col(a).dot(t.gradient.col(b)));
        }
      }
    }
    SparseMatrix laplacian(vertices - 1, vertices - 1);
    laplacian.setFromTriplets(entries.begin(), entries.end());
    factor_.compute(laplacian);
  }

  /// gradient_at(t) is that of the triangle t [3 × 2]. The result stands anywhere.
  template <typename GradientAt>
  Points positions(GradientAt gradient_at) const {
    Points divergence = Points::Zero(3, vertices_);
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
      const Triangle& triangle = triangles_[t];
      const Matrix3d pulls = triangle.weight * gradient_at(t) * triangle.gradient;
      for (std::size_t i = 0; i < 3; ++i) {
        divergence.col(triangle.corners[i]) += pulls.col(static_cast<Index>(i));
      }
    }
    Points result = Points::Zero(3, vertices_);
    result.rightCols(vertices_ - 1) =
        factor_.solve(divergence.rightCols(vertices_ - 1).transpose()).transpose();
    return result;
  }

 private:
  const std::vector<Triangle>& triangles_;
  Index vertices_;
  Factor factor_;
};

std::vector<Triangle> triangles_of(const Sheet& sheet, const Points& target, Rotations& rotations) {
  std::vector<Triangle> triangles(static_cast<std::size_t>(sheet.triangles.cols()));
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const auto corners = sheet.triangles.col(static_cast<Index>(t));
    Triangle& triangle = triangles[t];
    triangle.corners = {corners[0], corners[1], corners[2]};
    const Vector3d origin = sheet.initial.col(corners[0]);
    Frame sides;
    sides << sheet.initial.col(corners[1]) - origin, sheet.initial.col(corners[2]) - origin;
    triangle.plane.col(0) = sides.col(0).normalized();
    const Vector3d normal = sides.col(0).cross(sides.col(1));
    triangle.plane.col(1) = normal.cross(sides.col(0)).normalized();
    const Matrix2d flat = triangle.plane.transpose() * sides;
    triangle.gradient.rightCols<2>() = flat.inverse().transpose();
    triangle.gradient.col(0) = -triangle.gradient.rightCols<2>().rowwise().sum();
    triangle.weight = sheet.triangle_weight[static_cast<Index>(t)] * 0.5 * normal.norm();
    const Polar way = polar(triangle.gradient_of(target));
    triangle.stretch = way.stretch;
    rotations.emplace_back(with_normal(way.rotation) * with_normal(triangle.plane).transpose());
  }
  return triangles;
}

/// The mean of each face's triangles, which lie close together.
Rotations rotations_of_faces(const Sheet& sheet, const Rotations& of_triangles) {
  Rotations result;
  std::size_t t = 0;
  for (const auto& face : sheet.faces) {
    const Quaterniond& first = of_triangles[t];
    Eigen::Vector4d sum = Eigen::Vector4d::Zero();
    for (const std::size_t end = t + triangles_in(face); t < end; ++t) {
      sum += (of_triangles[t].dot(first) < 0 ? -1 : 1) * of_triangles[t].coeffs();
    }
    result.emplace_back(sum.normalized());
  }
  return result;
}

/// All pairs of faces that share an edge.
std::vector<Neighbours> neighbours_of(const Sheet& sheet, const Rotations& rotations) {
  std::map<std::pair<Index, Index>, std::size_t> beside;
  std::vector<Neighbours> pairs;
  for (std::size_t f = 0; f < sheet.faces.size(); ++f) {
    const auto& face = sheet.faces[f];
    for (std::size_t i = 0; i < face.size(); ++i) {
      const auto [at, is_new] =
          beside.try_emplace(std::minmax(face[i], face[(i + 1) % face.size()]), f);
      if (is_new) continue;
      const std::size_t other = at->second;
      pairs.push_back({other, f, logarithm(rotations[other].conjugate() * rotations[f])});
    }
  }
  return pairs;
}

/// How the faces turn: neighbours keep turning against each other as they do from the initial shape
/// to the target, at a steady rate about an axis that goes with them. With δ the rotation vector
/// between two of them, in the initial shape, their angular velocities differ by Ω_g − Ω_f = R·δ;
/// least squares over all pairs, a Poisson equation on the faces, give Ω at any moment. So no face
/// needs a branch of its own rotation vector, and a sheet may roll up any number of times.
class Turning {
 public:
  Turning(const Sheet& sheet, const Rotations& rotations)
      : count_(static_cast<Index>(rotations.size())), pairs_(neighbours_of(sheet, rotations)) {
    std::vector<Eigen::Triplet<double>> entries;
    for (const Neighbours& pair : pairs_) {
      const auto f = static_cast<Index>(pair.one), g = static_cast<Index>(pair.other);
      entries.emplace_back(f, f, 1);
      entries.emplace_back(g, g, 1);
      entries.emplace_back(f, g, -1);
      entries.emplace_back(g, f, -1);
    }
    // Ω is known up to a turn of the whole, of which it is to have none; a trace on the diagonal
    // lets one solve for any, and its mean is then taken away.
    constexpr double trace = 1e-9;
    for (Index f = 0; f < count_; ++f) entries.emplace_back(f, f, trace);
    SparseMatrix laplacian(count_, count_);
    laplacian.setFromTriplets(entries.begin(), entries.end());
    factor_.compute(laplacian);
  }

  /// The rotations at all samples, by steps of second order (Adams and Bashforth).
  std::vector<Rotations> samples() const {
    std::vector<Rotations> all = {
        Rotations(static_cast<std::size_t>(count_), Quaterniond::Identity())};
    Points before = velocities(all.front());
    before = velocities(turned(all.front(), before, -sample_step));
    while (static_cast<Index>(all.size()) < sample_count) {
      const Points now = velocities(all.back());
      all.push_back(turned(all.back(), 1.5 * now - 0.5 * before, sample_step));
      before = now;
    }
    return all;
  }

 private:
  Points velocities(const Rotations& at) const {
    Points moments = Points::Zero(3, count_);
    for (const Neighbours& pair : pairs_) {
      const Vector3d difference = 0.5 * (at[pair.one] * pair.turn + at[pair.other] * pair.turn);
      moments.col(static_cast<Index>(pair.other)) += difference;
      moments.col(static_cast<Index>(pair.one)) -= difference;
    }
    return shape_of(factor_.solve(moments.transpose()).transpose());
  }

  static Rotations turned(const Rotations& from, const Points& velocities, double step) {
    Rotations to(from.size());
    for (std::size_t f = 0; f < from.size(); ++f) {
      to[f] = (exponential(step * velocities.col(static_cast<Index>(f))) * from[f]).normalized();
    }
    return to;
  }

  Index count_;
  std::vector<Neighbours> pairs_;
  Factor factor_;
};

/// The mean of rotations: their vectors about it sum to zero.
Quaterniond mean_rotation(const Rotations& rotations, const std::vector<Triangle>& triangles) {
  Matrix3d sum = Matrix3d::Zero();
  double total = 0;
  for (std::size_t t = 0; t < rotations.size(); ++t) {
    sum += triangles[t].weight * rotations[t].toRotationMatrix();
    total += triangles[t].weight;
  }
  const Eigen::JacobiSVD<Matrix3d> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double sign = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
  Quaterniond mean(
      Matrix3d(svd.matrixU() * Vector3d(1, 1, sign).asDiagonal() * svd.matrixV().transpose()));
  for (int iteration = 0; iteration < 8; ++iteration) {
    Vector3d offset = Vector3d::Zero();
    for (std::size_t t = 0; t < rotations.size(); ++t) {
      offset += triangles[t].weight / total * logarithm(rotations[t] * mean.conjugate());
    }
    mean = (exponential(offset) * mean).normalized();
  }
  return mean;
}

/// Derivatives at the samples of the cubic spline through them, not-a-knot at both ends.
std::vector<Points> spline_derivatives(const std::vector<Points>& y) {
  const std::size_t n = y.size();
  std::vector<Points> d(n);
  std::vector<double> upper(n);  // Thomas algorithm; the first row is d₀ + 2·d₁
  d[0] = (-2.5 * y[0] + 2 * y[1] + 0.5 * y[2]) / sample_step;
  upper[0] = 2;
  for (std::size_t k = 1; k + 1 < n; ++k) {
    const double pivot = 4 - upper[k - 1];
    upper[k] = 1 / pivot;
    d[k] = (3 / sample_step * (y[k + 1] - y[k - 1]) - d[k - 1]) / pivot;
  }
  const Points last = (2.5 * y[n - 1] - 2 * y[n - 2] - 0.5 * y[n - 3]) / sample_step;
  d[n - 1] = (last - 2 * d[n - 2]) / (1 - 2 * upper[n - 2]);
  for (std::size_t k = n - 1; k-- > 0;) d[k] -= upper[k] * d[k + 1];
  return d;
}

}  // namespace

struct SheetMorph::Samples {
  Vector3d turn;                   ///< of the whole, rotation vector from s = 0 to 1
  std::vector<Points> position;    ///< without it, about the mass centre
  std::vector<Points> derivative;  ///< with respect to s
};

SheetMorph::SheetMorph(const Problem& problem, double step_time)
    : settles_(problem.arrival == Arrival::settle),
      start_rate_((settles_ ? 2 : 1) / problem.arrival_time),
      step_time_(step_time) {
  const Sheet& sheet = problem.sheet();
  Rotations rotations;
  const std::vector<Triangle> triangles = triangles_of(sheet, problem.target, rotations);
  const std::vector<Rotations> ways =
      Turning(sheet, rotations_of_faces(sheet, rotations)).samples();
  std::vector<std::size_t> face_of;
  for (std::size_t f = 0; f < sheet.faces.size(); ++f) {
    face_of.resize(face_of.size() + triangles_in(sheet.faces[f]), f);
  }

  // What the whole turns by, and what is then missing of each triangle's rotation.
  const std::size_t count = triangles.size();
  const auto arrived = [&](std::size_t t) { return ways.back()[face_of[t]]; };
  Rotations whole(count);
  for (std::size_t t = 0; t < count; ++t) whole[t] = rotations[t] * arrived(t).conjugate();
  const Quaterniond turn = mean_rotation(whole, triangles);
  std::vector<Vector3d> missing(count);
  for (std::size_t t = 0; t < count; ++t) {
    missing[t] = logarithm(arrived(t).conjugate() * (turn.conjugate() * rotations[t]));
  }

  auto samples = std::make_shared<Samples>();
  samples->turn = logarithm(turn);
  const Integrator integrator(triangles, sheet.particles());
  for (std::size_t k = 0; k < ways.size(); ++k) {
    const double s = static_cast<double>(k) * sample_step;
    const Points x = integrator.positions([&](std::size_t t) -> Frame {
      const Quaterniond rotation = ways[k][face_of[t]] * exponential(s * missing[t]);
      return rotation.toRotationMatrix() * triangles[t].plane * triangles[t].stretch_at(s);
    });
    samples->position.push_back(sheet.shape_of(x));
  }
  samples->position.front() = sheet.shape_of(sheet.initial);
  samples->position.back() = turn.toRotationMatrix().transpose() * sheet.shape_of(problem.target);
  samples->derivative = spline_derivatives(samples->position);
  samples_ = samples;
}

Points SheetMorph::shape() const {
  const double t = static_cast<double>(step_) * step_time_;
  const double s = settles_ ? t * (2 - t) : t;
  const auto k = static_cast<std::size_t>(
      std::clamp<double>(std::floor(s / sample_step), 0, static_cast<double>(sample_count - 2)));
  const double u = s / sample_step - static_cast<double>(k), v = 1 - u;
  const auto& [turn, position, derivative] = *samples_;
  return exponential(s * turn).toRotationMatrix() *
         (v * v * (1 + 2 * u) * position[k] + u * u * (1 + 2 * v) * position[k + 1] +
          sample_step * u * v * (v * derivative[k] - u * derivative[k + 1]));
}

Points SheetMorph::velocity_at_start() const {
  const auto& [turn, position, derivative] = *samples_;
  Points velocity = derivative.front();
  for (Index i = 0; i < velocity.cols(); ++i) {
    velocity.col(i) += turn.cross(position.front().col(i).head<3>());
  }
  return start_rate_ * velocity;
}

void SheetMorph::advance() { ++step_; }

}  // namespace nuno
