#include <nuno/sheet_morph.h>

#include <gtest/gtest.h>

#include "../sheets.h"

namespace nuno {

TEST(Example, ASheetsMorphGoesFromTheOnePoseToTheOther) {
  const Problem problem = make_problem(throw_scene());
  SheetMorph morph(problem, 0.01);
  for (int i = 0; i < 100; ++i) morph.advance();
  EXPECT_LT((morph.shape() - problem.cloth().shape_of(problem.target)).norm(), 1e-9);
}

}  // namespace nuno
