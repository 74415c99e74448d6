#include <nuno/points.h>

#include <cassert>

namespace nuno {

// Sums go from the last column to the first, the order in which the native kernel updates the
// particles, so that both see the same centroid to the last bit.
namespace {

template <int dimension>
Vector mass_center_in(const Points& points, const Vector& relative_mass) {
  const Eigen::Map<const Eigen::Matrix<double, dimension, Eigen::Dynamic>> fixed(
      points.data(), dimension, points.cols());
  Eigen::Matrix<double, dimension, 1> sum = Eigen::Matrix<double, dimension, 1>::Zero();
  for (Index i = points.cols(); i-- > 0;) sum += relative_mass[i] * fixed.col(i);
  return sum / static_cast<double>(points.cols());
}

}  // namespace

Vector centroid(const Points& points) {
  assert(points.cols() > 0);
  Vector sum = Vector::Zero(points.rows());
  for (Index i = points.cols(); i-- > 0;) sum += points.col(i);
  return sum / static_cast<double>(points.cols());
}

Points shape_of(const Points& points) { return points.colwise() - centroid(points); }

Vector mass_center(const Points& points, const Vector& relative_mass) {
  assert(points.cols() > 0 && points.cols() == relative_mass.size());
  assert(points.rows() == 2 || points.rows() == 3);
  return points.rows() == 2 ? mass_center_in<2>(points, relative_mass)
                            : mass_center_in<3>(points, relative_mass);
}

Points shape_of(const Points& points, const Vector& relative_mass) {
  return points.colwise() - mass_center(points, relative_mass);
}

Vector segment_lengths(const Points& points) {
  const Index segments = points.cols() - 1;
  return (points.rightCols(segments) - points.leftCols(segments))
      .colwise()
      .stableNorm()
      .transpose();
}

Points resample(const Points& polyline, Index count) {
  assert(polyline.cols() >= 2 && count >= 2);
  const Vector lengths = segment_lengths(polyline);
  const double total = lengths.sum();
  Points points(polyline.rows(), count);
  Index segment = 0;
  double start = 0;  // arc length at the start of `segment`
  for (Index i = 0; i < count; ++i) {
    const double wanted = total * (static_cast<double>(i) / static_cast<double>(count - 1));
    while (segment + 1 < lengths.size() && start + lengths[segment] < wanted) {
      start += lengths[segment++];
    }
    const double along =
        lengths[segment] > 0 ? std::min(1.0, (wanted - start) / lengths[segment]) : 0.0;
    points.col(i) =
        polyline.col(segment) + along * (polyline.col(segment + 1) - polyline.col(segment));
  }
  points.col(0) = polyline.col(0);
  points.col(count - 1) = polyline.col(polyline.cols() - 1);
  return points;
}

}  // namespace nuno
