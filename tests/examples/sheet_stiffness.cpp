#include <nuno/sheet_stiffness.h>

#include <gtest/gtest.h>

#include "../sheets.h"

namespace nuno {

TEST(Example, StiffnessResistsStretchingAndLetsPlacesBe) {
  const Problem problem = make_problem(square(5, 1));
  const Sheet& sheet = problem.sheet();
  const Eigen::SparseMatrix<double> stiffness = stiffness_matrix(sheet, sheet.initial);
  const Points place = Points::Ones(3, sheet.particles());
  EXPECT_LT((stiffness * place.reshaped()).norm(), 1e-9 * stiffness.norm());
  const Vector stretched = sheet.initial.reshaped();
  EXPECT_GT(stretched.dot(stiffness * stretched), 0);
}

}  // namespace nuno
