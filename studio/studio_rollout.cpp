#include "studio/studio_rollout.h"

#include <nuno/launch.h>
#include <nuno/reference_motion.h>
#include <nuno/shape_control.h>

#include <algorithm>
#include <cmath>

namespace nuno::studio {

Flight fly(const Backend& backend, const Gains& gains, Index frames, double after) {
  const Problem& problem = backend.problem();
  const double h = backend.time_step();
  const ShapeControl control(problem, gains);
  const Index steps = backend.steps();
  const Index last = steps + static_cast<Index>(std::floor(after / h));

  ReferenceMotion reference(problem, h);
  const auto cloth = backend.start(launch(backend));
  Points forces = Points::Zero(problem.cloth().dimension(), problem.cloth().particles());
  Flight result;
  Index frame = 0;
  for (Index n = 0; n <= last; ++n) {
    problem.stop_where_asked();
    if (!cloth->positions().allFinite()) break;
    if (control.pulls() && n <= steps) {
      control.pull(reference, cloth->positions(), cloth->velocities(), forces);
    } else {
      forces.setZero();
    }
    // Frame f stands at step round(f·steps/frames): frame 0 at the launch, frame `frames` at t₀.
    const auto due =
        static_cast<Index>(std::llround(static_cast<double>(frame) * static_cast<double>(steps) /
                                        static_cast<double>(std::max<Index>(frames, 1))));
    if (n == due) {
      result.times.push_back(static_cast<double>(n) * h);
      result.positions.push_back(cloth->positions());
      result.forces.push_back(forces);
      ++frame;
      // More frames than steps: the frames between two steps are left out.
      while (std::llround(static_cast<double>(frame) * static_cast<double>(steps) /
                          static_cast<double>(std::max<Index>(frames, 1))) <= n) {
        ++frame;
      }
    }
    if (n == steps) forces.setZero();
    if (n < last) cloth->step(forces);
    if (n < steps) reference.advance();
  }
  return result;
}

}  // namespace nuno::studio
