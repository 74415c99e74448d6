#include <nuno/backend.h>

#include <nuno/parallel.h>
#include <nuno/rollout.h>

#include <cassert>

namespace nuno {

double Backend::do_largest_gain() const {
  const double h = time_step();
  return 0.04 * cloth().particle_mass / (h * h);
}

const LowModes& Backend::low_modes(Index groups) const {
  assert(groups >= 1 && groups <= most_groups);
  Found& found = low_modes_[static_cast<std::size_t>(groups - 1)];
  std::call_once(found.once, [&] { found.modes.emplace(problem_, groups); });
  return *found.modes;
}

std::vector<double> Backend::do_errors(std::span<const Gains> gains, const Points& initial) const {
  std::vector<double> result(gains.size());
  parallel_for(static_cast<Index>(gains.size()), [&](Index i) {
    const auto at = static_cast<std::size_t>(i);
    result[at] = rollout(*this, gains[at], {}, initial).error.mean;
  });
  return result;
}

std::vector<ErrorSample> Backend::do_error_samples(std::span<const Gains>) const {
  assert(!"this engine has no derivatives");
  return {};
}

RolloutJacobian Backend::do_jacobian(double, const CorrectionDirections&) const {
  assert(!"this engine has no jacobian");
  return {};
}

RolloutGradient Backend::do_gradient(double, const CotangentAt&) const {
  assert(!"this engine has no gradient");
  return {};
}

RolloutGradient Backend::gradient(double gain, const Points& arrival_cotangent) const {
  return gradient(gain, [&](const Points&) { return RolloutCotangent{arrival_cotangent}; });
}

RolloutGradient Backend::error_gradient(double gain) const {
  return gradient(gain, [&](const Points& final) {
    return RolloutCotangent{error_cotangent(final, problem().target)};
  });
}

std::vector<double> Backend::errors(std::span<const double> gains) const {
  return errors(std::vector<Gains>(gains.begin(), gains.end()));
}

std::vector<ErrorSample> Backend::error_samples(std::span<const double> gains) const {
  return error_samples(std::vector<Gains>(gains.begin(), gains.end()));
}

}  // namespace nuno
