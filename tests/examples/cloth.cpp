#include <nuno/cloth.h>

#include <gtest/gtest.h>

namespace nuno {

TEST(Example, AChainHasRestLengthsAndMasses) {
  const Chain chain = make_chain(Points{{0.0, 0.5, 1.0}, {0.0, 0.0, 0.0}}, {.mass = 0.3}, 9.8);
  EXPECT_EQ(chain.edges.cols(), 2);
  EXPECT_NEAR(chain.size, 1, 1e-12);
  EXPECT_NEAR(chain.particle_mass, 0.1, 1e-12);
}

}  // namespace nuno
