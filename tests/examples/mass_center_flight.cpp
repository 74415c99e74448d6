#include <nuno/mass_center_flight.h>

#include <gtest/gtest.h>

#include <nuno/launch.h>
#include <nuno/native.h>
#include "arch.h"

namespace nuno {

TEST(Example, TheMassCentreFliesAlone) {
  const auto backend = native::make_backend(make_problem(arch()));
  const Points velocities = launch(*backend);
  MassCenterFlight flight(*backend, backend->cloth().initial, velocities);
  for (Index i = 0; i < backend->steps(); ++i) flight.step(Vector::Zero(2));
  EXPECT_LT((flight.position() - centroid(backend->problem().target)).norm(), 1e-9);
}

}  // namespace nuno
