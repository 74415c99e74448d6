#include <nuno/bullet.h>

#include "sheet_simulation.h"
#include "step_choice.h"
#include "unit_sheet.h"

namespace nuno::bullet {
namespace {

class SheetBackend final : public Backend {
 public:
  SheetBackend(const Problem& problem, Index steps)
      : Backend("bullet", problem, steps), sheet_(make_unit_sheet(problem.sheet(), time_step())) {}

 private:
  DragRecurrence do_drag_recurrence() const override {
    const double h = sheet_.h;
    return {h, sheet_.first.keep, sheet_.first.kick * h, sheet_.other.keep, sheet_.other.kick * h};
  }

  std::unique_ptr<Simulation> do_start(const Points& positions,
                                       const Points& velocities) const override {
    return make_simulation(sheet_, MassCenterFlight(*this, positions, velocities), positions,
                           velocities);
  }

  // A hundred times the rounding that a flight collects in single precision.
  double do_smallest_perturbation() const override { return 1e-4; }

  UnitSheet sheet_;
};

}  // namespace

std::unique_ptr<Backend> make_backend(const Problem& problem) {
  if (!problem.is_sheet()) {
    throw InputError("bullet flies sheets; a chain flies on native and on box2d");
  }
  return std::make_unique<SheetBackend>(problem, count_steps(problem));
}

}  // namespace nuno::bullet
