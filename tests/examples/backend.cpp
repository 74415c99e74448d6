#include <nuno/backend.h>

#include <gtest/gtest.h>

#include <nuno/native.h>
#include "arch.h"

namespace nuno {

// A whole engine is in tests/own_engine.h. Who has one flies it step by step, or by rollout.h.
TEST(Example, AnEngineStartsASimulationAndStepsIt) {
  const std::unique_ptr<Backend> backend = native::make_backend(make_problem(arch()));
  const Points still = Points::Zero(2, backend->cloth().particles());
  const std::unique_ptr<Simulation> fall = backend->start(still);
  for (Index i = 0; i < backend->steps(); ++i) fall->step(still);  // no force but gravity and drag
  EXPECT_LT(fall->positions().row(1).maxCoeff(), backend->cloth().initial.row(1).minCoeff());
}

}  // namespace nuno
