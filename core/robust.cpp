#include <nuno/robust.h>

#include <nuno/rollout.h>

#include <cassert>

namespace nuno {

Objective robust_objective(const Backend& backend, const RobustOptions& options) {
  assert(options.size > 0 && options.perturbations >= 1);
  const Problem& problem = backend.problem();
  std::vector<Points> starts = {problem.cloth().initial};
  for (unsigned seed = 1; seed <= options.perturbations; ++seed) {
    starts.push_back(perturbed(problem, options.size, seed));
  }
  Objective result = objective(backend);
  result.samples = nullptr;
  result.errors = [&backend, starts = std::move(starts)](std::span<const double> gains) {
    const std::vector<Gains> all(gains.begin(), gains.end());
    std::vector<double> mean(gains.size(), 0.0);
    for (const Points& start : starts) {
      const std::vector<double> errors = backend.errors(all, start);
      for (std::size_t i = 0; i < gains.size(); ++i) {
        mean[i] += errors[i] / static_cast<double>(starts.size());
      }
    }
    return mean;
  };
  return result;
}

}  // namespace nuno
