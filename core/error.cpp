#include <nuno/error.h>

#include <cassert>

namespace nuno {

ArrivalError arrival_error(const Cloth& cloth, const Points& final, const Points& target) {
  ArrivalError error = arrival_error(final, target);
  error.centroid = (cloth.mass_center(final) - cloth.mass_center(target)).norm();
  return error;
}

ArrivalError arrival_error(const Points& final, const Points& target) {
  assert(final.rows() == target.rows() && final.cols() == target.cols());
  const Vector distance = (final - target).colwise().stableNorm().transpose();
  return {distance.mean(), distance.maxCoeff(), (centroid(final) - centroid(target)).norm()};
}

Points error_cotangent(const Points& final, const Points& target) {
  Points cotangent = final - target;
  const auto particles = static_cast<double>(final.cols());
  for (auto each : cotangent.colwise()) {
    const double distance = each.norm();
    if (distance > 0) each /= distance * particles;
  }
  return cotangent;
}

ShapeDifference shape_difference(const Cloth& cloth, const Points& a, const Points& b) {
  const ArrivalError difference = arrival_error(cloth.shape_of(a), cloth.shape_of(b));
  return {difference.mean, difference.max};
}

ShapeDifference shape_difference(const Points& a, const Points& b) {
  const ArrivalError difference = arrival_error(shape_of(a), shape_of(b));
  return {difference.mean, difference.max};
}

}  // namespace nuno
