#include <nuno/result_file.h>

#include <gtest/gtest.h>

#include <nuno/native.h>
#include <nuno/output.h>
#include "arch.h"

namespace nuno {

TEST(Example, AFlightIsWrittenAsAResult) {
  const auto backend = native::make_backend(make_problem(arch()));
  const Rollout flight = rollout(*backend, 0, {.frames_per_second = 10});
  const File file(std::tmpfile());
  write_result(file.get(), arch(), *backend, flight, 1, std::nullopt);
  EXPECT_GT(std::ftell(file.get()), 1000);
}

}  // namespace nuno
