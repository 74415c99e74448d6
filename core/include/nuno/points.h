#pragma once

#include <Eigen/Core>

namespace nuno {

using Eigen::Index;

/// A shape, or one vector for every particle: [dimension × particles], a column each.
using Points = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic>;

/// One vector [dimension], or one number for every particle, segment or hinge.
using Vector = Eigen::VectorXd;

/// Mean of the columns [dimension]. Needs at least one column.
Vector centroid(const Points& points);

/// The points moved so that their centroid is the origin.
Points shape_of(const Points& points);

/// The same with masses that differ: mean of the columns, each times its relative mass mᵢ/m̄ [N].
/// Where all are 1, equal to those above to the last bit.
Vector mass_center(const Points& points, const Vector& relative_mass);
Points shape_of(const Points& points, const Vector& relative_mass);

/// Lengths of the segments between neighbouring columns [particles − 1].
Vector segment_lengths(const Points& points);

/// `count` points at equal arc length along a drawn polyline; the first and the last are the
/// polyline's own. Repeated points are harmless. Needs count ≥ 2 and two distinct points.
Points resample(const Points& polyline, Index count);

}  // namespace nuno
