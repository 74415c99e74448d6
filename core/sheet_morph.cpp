#include <nuno/sheet_morph.h>

namespace nuno {

struct SheetMorph::Samples {
  Points from, to;
};

SheetMorph::SheetMorph(const Problem& problem, double step_time)
    : samples_(
          std::make_shared<const Samples>(Samples{problem.cloth().shape_of(problem.cloth().initial),
                                                  problem.cloth().shape_of(problem.target)})),
      settles_(problem.arrival == Arrival::settle),
      start_rate_((settles_ ? 2 : 1) / problem.arrival_time),
      step_time_(step_time) {}

Points SheetMorph::shape() const {
  const double s = settles_ ? time_ * (2 - time_) : time_;
  return samples_->from + s * (samples_->to - samples_->from);
}

Points SheetMorph::velocity_at_start() const {
  return start_rate_ * (samples_->to - samples_->from);
}

void SheetMorph::advance() { time_ += step_time_; }

}  // namespace nuno
