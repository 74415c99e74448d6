#include <nuno/optimize.h>

#include <gtest/gtest.h>

namespace nuno {

TEST(Example, TheBestGainIsFoundByValuesAlone) {
  Objective bowl;  // of any E(α); that of an engine's problem is objective(backend)
  bowl.errors = [](std::span<const double> gains) {
    std::vector<double> errors;
    for (const double gain : gains) errors.push_back(0.1 + (gain - 2) * (gain - 2));
    return errors;
  };
  const OptimizeSummary best = global_search(bowl);
  EXPECT_EQ(best.status, OptimizeStatus::converged) << best.reason;
  EXPECT_NEAR(best.gain, 2, 1e-3);
}

}  // namespace nuno
