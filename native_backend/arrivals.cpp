#include "arrivals.h"

#include <nuno/error.h>
#include <nuno/rollout.h>

#include <limits>
#include <utility>

namespace nuno::native {

Arrival arrival_of(const Problem& problem, const double* final, const double* derivative) {
  const Points& target = problem.target;
  const Eigen::Map<const Points> positions(final, target.rows(), target.cols());
  Arrival arrival;
  if (is_torn(problem.cloth(), positions)) {
    arrival.error = std::numeric_limits<double>::infinity();
    return arrival;
  }
  arrival.error = arrival_error(positions, target).mean;
  if (derivative == nullptr) return arrival;
  arrival.residual = positions - target;
  arrival.derivative.residual = Eigen::Map<const Points>(derivative, target.rows(), target.cols());
  double sum = 0;
  for (Index i = 0; i < target.cols(); ++i) {
    const double distance = arrival.residual.col(i).norm();
    if (distance > 0) {
      sum += arrival.residual.col(i).dot(arrival.derivative.residual.col(i)) / distance;
    }
  }
  arrival.derivative.error = sum / static_cast<double>(target.cols());
  return arrival;
}

std::vector<ErrorSample> samples_of(std::vector<Arrival> arrivals, Index copies) {
  const auto each = static_cast<std::size_t>(copies);
  std::vector<ErrorSample> samples(arrivals.size() / each);
  for (std::size_t i = 0; i < arrivals.size(); ++i) {
    ErrorSample& sample = samples[i / each];
    sample.error = arrivals[i].error;
    sample.residual = std::move(arrivals[i].residual);
    sample.derivatives.push_back(std::move(arrivals[i].derivative));
  }
  return samples;
}

}  // namespace nuno::native
