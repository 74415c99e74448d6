#pragma once

#include <nuno/backend.h>

#include <vector>

namespace nuno::native {

/// How a flight of a kernel arrives, and the derivatives with respect to one of its gains.
struct Arrival {
  double error = 0;  ///< [m]; +∞ where the cloth is torn, and then no more is known
  Points residual;   ///< [d × N], m; where derivatives are asked for
  ErrorSample::Derivative derivative;
};

/// Of a flight's final positions and, unless that is null, their derivatives [d·N each, a particle
/// after another].
Arrival arrival_of(const Problem& problem, const double* final, const double* derivative);

/// The arrivals of `copies` flights a sample, each with the derivative by another group.
std::vector<ErrorSample> samples_of(std::vector<Arrival> arrivals, Index copies);

}  // namespace nuno::native
