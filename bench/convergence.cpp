#include "convergence.h"

#include <nuno/native.h>
#include <nuno/optimize.h>

#include <algorithm>
#include <cmath>

namespace nuno::bench {
namespace {

double largest_difference(std::span<const double> a, std::span<const double> b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
  return largest;
}

}  // namespace

Convergence::Convergence(const Backend& native) {
  const double h = native.time_step();
  // The best gain of a finer chain: the one of a step that is too long may be an artefact of it.
  const std::unique_ptr<Backend> fine =
      native::make_backend(with_time_step(native.problem(), h / 4));
  const double best = global_search(objective(*fine)).gain;
  gains_ = {0, 0.5 * best, best};
  const std::unique_ptr<Backend> coarser =
      native::make_backend(with_time_step(native.problem(), h / 16));
  limit_ = native::make_backend(with_time_step(native.problem(), h / 32));
  errors_ = limit_->errors(gains_);
  uncertainty_ = largest_difference(coarser->errors(gains_), errors_);
}

double Convergence::off(const Backend& backend) const {
  return largest_difference(backend.errors(gains_), errors_);
}

double Convergence::off(const PlainChain& chain) const {
  std::vector<double> errors;
  for (const double gain : gains_) errors.push_back(chain.error(gain));
  return largest_difference(errors, errors_);
}

double Convergence::error(double gain) const { return limit_->errors({&gain, 1}).front(); }

}  // namespace nuno::bench
