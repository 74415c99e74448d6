#include <nuno/target_order.h>

#include <gtest/gtest.h>

#include <nuno/native.h>
#include "arch.h"

namespace nuno {

TEST(Example, ATargetDrawnTheOtherWayRoundIsNoticed) {
  EXPECT_FALSE(compare_target_orders(arch(), native::make_backend));
  const auto orders = compare_target_orders(reversed(arch()), native::make_backend);
  ASSERT_TRUE(orders);
  EXPECT_LT(orders->the_other_way.error, orders->as_asked.error);
  EXPECT_NE(advice(*orders), "");
}

}  // namespace nuno
