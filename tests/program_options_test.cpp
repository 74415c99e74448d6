// Options of the program that change what is flown, or what is told of it.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "glb_file.h"
#include "program.h"

namespace nuno {
namespace {

class Options : public Program {};

TEST_F(Options, TakeAShorterStepForTheLargestOfSeveralGains) {
  const auto time_step = [&](const std::string& gains) {
    return simulated({"simulate", scene("s-curve-32"), "--alpha", gains})["time_step"]
        .get<double>();
  };
  const double strong = time_step("1000");
  EXPECT_LT(strong, time_step("0.02"));
  EXPECT_EQ(time_step("0.02,1000"), strong);
  EXPECT_EQ(time_step("1000,0.02"), strong);
}

TEST_F(Options, HoldTheFirstShapeBeforeTheThrow) {
  const auto thrown = [&](const std::string& frames) {
    const std::string path = output(frames + ".glb");
    EXPECT_EQ(
        nuno({"simulate", scene("s-curve-32"), "--hold-frames", frames, "--out", path}).status, 0);
    return GlbFile(read_text(path));
  };
  const GlbFile at_once = thrown("0"), held = thrown("12");
  const Points keys = at_once.sampler("input"), later = held.sampler("input");
  ASSERT_EQ(later.cols(), keys.cols() + 12);
  const auto apart = [&](std::size_t of_held, std::size_t of_other) {
    return (held.at_frame("POSITION", of_held) - at_once.at_frame("POSITION", of_other))
        .cwiseAbs()
        .maxCoeff();
  };
  constexpr double float_rounding = 1e-6;  // of numbers below 8
  for (Index k = 0; k < 12; ++k) {
    EXPECT_FLOAT_EQ(static_cast<float>(later(0, k)), static_cast<float>(k) / 60);
    EXPECT_LT(apart(static_cast<std::size_t>(k), 0), float_rounding);
  }
  for (Index k = 0; k < keys.cols(); ++k) {
    EXPECT_FLOAT_EQ(static_cast<float>(later(0, k + 12)), static_cast<float>(keys(0, k) + 0.2));
  }
  EXPECT_LT(apart(12 + 30, 30), float_rounding);
}

}  // namespace
}  // namespace nuno
