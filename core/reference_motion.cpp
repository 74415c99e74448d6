#include <nuno/reference_motion.h>

#include <utility>

namespace nuno {
namespace {

CorrectionShares correction_shares_at(double time) {
  static_assert(correction_powers == std::array{1, 6, 36, 216}, "each is six times the one before");
  CorrectionShares shares;
  double share = time;
  for (double& each : shares) {
    each = share;
    const double squared = share * share;
    share = squared * squared * squared;
  }
  return shares;
}

}  // namespace

CorrectionShares correction_rates_at_start(double arrival_time) {
  CorrectionShares rates;
  for (std::size_t k = 0; k < rates.size(); ++k) {
    rates[k] = correction_powers[k] == 1 ? 1 / arrival_time : 0;
  }
  return rates;
}

ReferenceMotion::ReferenceMotion(const Problem& problem, double time_step)
    : moves_(problem.reference == Reference::morph),
      time_step_(time_step),
      step_time_(time_step / problem.arrival_time),
      stop_(problem.stop) {
  std::vector<Points> offsets;
  for (const Points& offset : problem.reference_correction) {
    offsets.push_back(problem.cloth().shape_of(offset));
  }
  offsets_ = std::make_shared<const std::vector<Points>>(std::move(offsets));
  correction_rates_ = correction_rates_at_start(problem.arrival_time);
  if (!moves_) {
    way_ = std::make_shared<const Points>(problem.cloth().shape_of(problem.target));
    velocity_ = Points::Zero(problem.target.rows(), problem.target.cols());
  } else if (problem.is_sheet()) {
    const SheetMorph& morph = way_.emplace<SheetMorph>(problem, step_time_);
    velocity_ = morph.velocity_at_start();
  } else {
    const ChainMorph& morph = way_.emplace<ChainMorph>(problem, step_time_);
    velocity_ = morph.velocity_at_start();
  }
  place_shape();
  add_correction(correction_rates_, velocity_);
}

void ReferenceMotion::advance() {
  if (stop_.stop_requested()) throw Stopped();
  time_ += step_time_;
  const CorrectionShares shares = correction_shares_at(time_);
  for (std::size_t k = 0; k < shares.size(); ++k) {
    correction_rates_[k] = (shares[k] - correction_shares_[k]) / time_step_;
  }
  correction_shares_ = shares;
  if (!moves_ && offsets_->empty()) return;

  const Points before = shape_;
  if (auto* morph = std::get_if<ChainMorph>(&way_)) morph->advance();
  if (auto* morph = std::get_if<SheetMorph>(&way_)) morph->advance();
  place_shape();
  velocity_ = (shape_ - before) / time_step_;
}

void ReferenceMotion::place_shape() {
  if (const auto* morph = std::get_if<ChainMorph>(&way_)) {
    shape_ = morph->shape();
  } else if (const auto* sheet = std::get_if<SheetMorph>(&way_)) {
    shape_ = sheet->shape();
  } else {
    shape_ = *std::get<std::shared_ptr<const Points>>(way_);
  }
  add_correction(correction_shares_, shape_);
}

void ReferenceMotion::add_correction(const CorrectionShares& shares, Points& to) const {
  for (std::size_t k = 0; k < offsets_->size(); ++k) to += shares[k] * (*offsets_)[k];
}

}  // namespace nuno
