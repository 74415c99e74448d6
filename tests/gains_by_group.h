#pragma once

#include <nuno/backend.h>

#include <gtest/gtest.h>

#include <vector>

namespace nuno {

inline Gains by_group(std::vector<double> groups) { return Gains::of_groups(groups); }

/// The derivatives of E by the gain of every group against differences.
inline void expect_derivatives(const Backend& backend, const Gains& gains) {
  const ErrorSample found = backend.error_samples({&gains, 1}).front();
  const std::vector<double> groups = gains.groups();
  ASSERT_EQ(found.derivatives.size(), groups.size());
  for (std::size_t k = 0; k < groups.size(); ++k) {
    const double d = 3e-4 * groups[k];
    std::vector<Gains> around;
    for (const double steps : {-2, -1, 1, 2}) {
      std::vector<double> moved = groups;
      moved[k] += steps * d;
      around.push_back(by_group(moved));
    }
    const std::vector<double> e = backend.errors(around);
    const double difference = (e[0] - 8 * e[1] + 8 * e[2] - e[3]) / (12 * d);
    // Fourth-order differences over 3e-4: at 1e-3 the curviest is 2e-5 off, at 1e-4 rounding is
    // 1e-6 of the slightest.
    EXPECT_NEAR(found.derivatives[k].error / difference, 1, 1e-6) << k << " of " << groups.size();
  }
}

}  // namespace nuno
