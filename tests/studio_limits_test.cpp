// What the studio's limits are measured in.

#include <gtest/gtest.h>

#include "studio.h"

namespace nuno {
namespace {

class StudioLimits : public Studio {};

TEST_F(StudioLimits, OfTheTimeAfterArrivalAreInArrivalTimes) {
  Json scene = Json::parse(small_scene);
  for (const double arrival_time : {0.2, 1.5}) {
    scene["arrival_time"] = arrival_time;
    const auto status = [&](double after) {
      return status_of(post("/api/simulate?frames=2&after=" + Json(after).dump(), scene.dump()));
    };
    EXPECT_EQ(status(9.9 * arrival_time), 200);
    EXPECT_EQ(status(10.1 * arrival_time), 400);
  }
}

}  // namespace
}  // namespace nuno
