// What a sheet's flight tends to as its step and its mesh get finer.

#include <nuno/native.h>
#include <nuno/rollout.h>

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "sheets.h"

namespace nuno {
namespace {

TEST(SheetConvergence, IsOfSecondOrderInTheStepUnderDampedControl) {
  for (const Reference reference : {Reference::hold, Reference::morph}) {
    for (const Arrival arrival : {Arrival::pass, Arrival::settle}) {
      if (reference == Reference::hold && arrival == Arrival::settle) continue;  // is the same
      for (const double times : {10.0, 100.0, 1000.0}) {
        SheetScene scene = throw_scene(false);
        scene.reference = reference;
        scene.arrival = arrival;
        const Problem problem = make_problem(scene);
        std::vector<Points> finals;
        for (const double h : {1.0 / 800, 1.0 / 1600, 1.0 / 3200}) {
          const auto backend = native::make_backend(with_time_step(problem, h));
          const Rollout flight = rollout(*backend, times * gain_scale(problem));
          finals.push_back(problem.cloth().shape_of(flight.final));
        }
        const double order =
            std::log2((finals[0] - finals[1]).norm() / (finals[1] - finals[2]).norm());
        EXPECT_NEAR(order, 2, 0.2) << "gain × " << times;
      }
    }
  }
}

TEST(SheetConvergence, TendsToOneErrorAsTheMeshIsRefined) {
  struct Control {
    Reference reference;
    double damping_ratio;
    double times;  // m̄/t₀²: the control is a force per area of cloth
  };
  for (const Control& control :
       {Control{Reference::hold, 0, 0}, Control{Reference::hold, 0, 3},
        Control{Reference::hold, 0.7, 10}, Control{Reference::morph, 0.7, 30},
        Control{Reference::morph, 0.7, 300}}) {
    for (const bool all_quads : {true, false}) {
      std::vector<double> errors;
      for (const Index columns : {8, 16, 32}) {
        SheetScene scene = throw_scene(all_quads, columns);
        scene.reference = control.reference;
        scene.damping_ratio = control.damping_ratio;
        const Problem problem = make_problem(scene);
        const auto backend = native::make_backend(problem);
        errors.push_back(rollout(*backend, control.times * gain_scale(problem)).error.mean /
                         problem.cloth().size);
      }
      const double coarse = std::abs(errors[1] - errors[0]);
      const double fine = std::abs(errors[2] - errors[1]);
      // Of first order in the spacing at least, as vertices at the border count like those inside.
      EXPECT_LT(fine, 0.65 * coarse)
          << control.times << ' ' << errors[0] << ' ' << errors[1] << ' ' << errors[2];
    }
  }
}

}  // namespace
}  // namespace nuno
