// The gradient of a whole flight of a sheet: forwards with a checkpoint every √steps steps, then
// backwards, where each stretch between two checkpoints is flown again and its steps are kept
// (Griewank 1992, with one level): two flights forwards, one back, and memory as √steps.

#include <nuno/launch.h>
#include <nuno/rollout.h>
#include <nuno/shape_control.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "sheet_adjoint.h"

namespace nuno::native {
namespace {

using Values = std::vector<double>;
using Vectors = Eigen::Map<Points>;

/// A sheet in flight, before a step.
struct Flight {
  SheetState state;
  ReferenceMotion reference;
  CorrectionShares rates_before;  ///< of the reference's corrections over the step before
  Points told;                    ///< velocities that control is told, see rollout; or empty
};

/// What the way back needs of a step, in the plan's order.
struct StepRecord {
  Values positions;         ///< before it [3 × N], m
  Values impulse;           ///< after the slow kick [3 × N], N
  Values length;            ///< of the springs before it [springs]; or empty
  Points pull;              ///< of control, on a particle of mean mass [3 × N], N; or empty
  Points pull_per_gain;     ///< its derivative [3 × N], m
  CorrectionShares felt{};  ///< what pull gains by a reference correction [N/m]
};

class FlightBack {
 public:
  FlightBack(const SheetPlan& plan, const Problem& problem, double gain)
      : plan_(plan),
        problem_(problem),
        relative_mass_(problem.cloth().relative_mass),
        mass_in_plan_(plan.particles),
        gain_(gain),
        damping_(shape_damping(plan.damping_ratio, gain, plan.particle_mass)),
        // β = 2ζ·√(α·m), as in `fly`.
        damping_per_gain_(gain > 0 ? 0.5 * damping_ / gain : 0) {
    for (Index i = 0; i < plan.particles; ++i) {
      mass_in_plan_[i] = relative_mass_[plan.user_index[static_cast<std::size_t>(i)]];
    }
  }

  RolloutGradient gradient(const SheetState& start, const CotangentAt& cotangent_at) {
    const auto stretch = static_cast<Index>(std::ceil(std::sqrt(static_cast<double>(plan_.steps))));
    RolloutGradient result;
    std::vector<Flight> checkpoints = fly_over(start, stretch, result);
    if (is_torn(problem_.cloth(), result.final)) return result;
    begin_back(cotangent_at(result.final));
    std::vector<StepRecord> records(static_cast<std::size_t>(stretch));
    while (!checkpoints.empty()) {
      const Index first = (static_cast<Index>(checkpoints.size()) - 1) * stretch;
      const Index count = std::min(stretch, plan_.steps - first);
      Flight flight = std::move(checkpoints.back());
      checkpoints.pop_back();
      turn_before_ = flight.state.turn;
      for (Index k = 0; k < count; ++k) advance(flight, &records[static_cast<std::size_t>(k)]);
      for (Index k = count; k-- > 0;) {
        step_back(first + k, records[static_cast<std::size_t>(k)],
                  k > 0 ? &records[static_cast<std::size_t>(k - 1)] : nullptr);
      }
    }
    tell(start, result);
    return result;
  }

 private:
  bool damped() const { return plan_.damping_ratio > 0; }

  Points in_user_order(const Values& values) const {
    Points points;
    native::in_user_order(plan_, values, points);
    return points;
  }
  void in_plan_order(const Points& points, Points& to) const {
    to.resize(3, plan_.particles);
    for (Index i = 0; i < plan_.particles; ++i) {
      to.col(i) = points.col(plan_.user_index[static_cast<std::size_t>(i)]);
    }
  }

  /// The whole flight, and its checkpoints, one before every `stretch` steps.
  std::vector<Flight> fly_over(const SheetState& start, Index stretch, RolloutGradient& result) {
    Flight flight{start, ReferenceMotion(problem_, plan_.time_step), {}, {}};
    flight.rates_before = flight.reference.correction_rates();
    if (damped()) {
      flight.told = in_user_order(start.velocities);
    } else {
      flight.state.velocities.clear();
    }
    std::vector<Flight> checkpoints;
    double squared_force = 0;
    for (Index n = 0; n < plan_.steps; ++n) {
      if (n % stretch == 0) checkpoints.push_back(flight);
      advance(flight, nullptr);
      squared_force += pull_.squaredNorm();
    }
    result.final = in_user_order(flight.state.positions);
    result.squared_effort = squared_force * effort_share();
    return checkpoints;
  }

  /// Of the control effort's square in a squared force [1/N²].
  double effort_share() const {
    const double unit = effort_unit(problem_);
    const auto samples = static_cast<double>(plan_.steps) * static_cast<double>(plan_.particles);
    return 1 / (samples * unit * unit);
  }

  /// One step. Control is that of the core's rollout, bit for bit.
  void advance(Flight& flight, StepRecord* record) {
    native::in_user_order(plan_, flight.state.positions, positions_);
    missing_ =
        flight.reference.shape() - (positions_.colwise() - mass_center(positions_, relative_mass_));
    pull_ = gain_ * missing_;
    if (damped()) {
      lag_ = flight.reference.velocity() -
             (flight.told.colwise() - mass_center(flight.told, relative_mass_));
      pull_ += damping_ * lag_;
    }
    if (record != nullptr) keep(flight, *record);
    forces_ = pull_.array().rowwise() * relative_mass_.transpose().array();
    const Points before = damped() ? in_user_order(flight.state.velocities) : Points();
    const Points reference_before = damped() ? flight.reference.velocity() : Points();
    flight.rates_before = flight.reference.correction_rates();
    kick(plan_, forces_, flight.state);
    if (record != nullptr) record->impulse = flight.state.impulse;
    swing(plan_, flight.state, nullptr);
    flight.reference.advance();
    if (!damped()) return;
    const Points velocities = in_user_order(flight.state.velocities);
    flight.told = velocities +
                  0.5 * ((velocities - before) - (flight.reference.velocity() - reference_before));
  }

  void keep(const Flight& flight, StepRecord& record) {
    record.positions = flight.state.positions;
    record.length = flight.state.length;
    if (effort_bar_ != 0) in_plan_order(pull_, record.pull);
    if (damped()) missing_ += damping_per_gain_ * lag_;
    in_plan_order(missing_, record.pull_per_gain);
    // By the shape, and by its velocity: lag has 1½ of that of now less ½ of that before.
    const CorrectionShares& shares = flight.reference.correction_shares();
    const CorrectionShares& rates = flight.reference.correction_rates();
    for (std::size_t k = 0; k < shares.size(); ++k) {
      record.felt[k] =
          gain_ * shares[k] + damping_ * (1.5 * rates[k] - 0.5 * flight.rates_before[k]);
    }
  }

  void begin_back(const RolloutCotangent& cotangent) {
    effort_bar_ = cotangent.squared_effort;
    const Points zero = Points::Zero(3, plan_.particles);
    Points arrival;
    in_plan_order(cotangent.arrival, arrival);
    cotangent_.positions.assign(arrival.data(), arrival.data() + arrival.size());
    cotangent_.impulse.assign(zero.data(), zero.data() + zero.size());
    cotangent_.length.assign(plan_.dashpot.size(), 0.0);
    cotangent_.turn.assign(plan_.hinge_dashpot.size(), 0.0);
    told_bar_ = told_bar_after_ = zero;
    corrections_bar_.fill(zero);
    gain_bar_ = 0;
  }

  /// Step `n` backwards; `before` is the one before it, unless that is of another stretch.
  void step_back(Index n, const StepRecord& record, const StepRecord* before) {
    const bool first = n == 0;
    const double end_share = 0.5 + 0.5 / static_cast<double>(plan_.substeps);
    const Points velocity_bar = 1.5 * told_bar_ - 0.5 * told_bar_after_;
    if (damped()) add_velocities_back(end_share, velocity_bar);
    SheetState kicked{first, record.positions, record.impulse, {}, record.length, {}};
    swing(plan_, kicked, &tape_);
    swing_back(plan_, first, tape_, cotangent_);
    if (damped()) add_velocities_back(1 - end_share, velocity_bar);
    if (!plan_.hinge_dashpot.empty()) {
      turn_.resize(plan_.hinge_dashpot.size());
      if (before != nullptr) {
        turns_at(plan_, before->positions, turn_);
      } else {
        turn_ = turn_before_;
      }
    }
    kick_back(plan_, first, record.positions, turn_, cotangent_);
    control_back(first, record);
  }

  /// The told velocity is `share`·(q/(r·m))·(u + m·g).
  void add_velocities_back(double share, const Points& velocity_bar) {
    const Eigen::Map<const Vector> speed(plan_.speed.data(), plan_.particles);
    Vectors(cotangent_.impulse.data(), 3, plan_.particles).array() +=
        velocity_bar.array().rowwise() * (share * speed).transpose().array();
  }

  /// With p̄ the cotangent of the pull on a particle of mean mass, of which each has mᵢ/m̄ as force:
  /// p = α·(shape − x + centre of x) + β·(velocity of the shape − told + centre of told).
  void control_back(bool first, const StepRecord& record) {
    const double kicks = (first ? plan_.first_share : 1) * static_cast<double>(plan_.substeps);
    pull_bar_ = Vectors(cotangent_.impulse.data(), 3, plan_.particles).array().rowwise() *
                (kicks * mass_in_plan_).transpose().array();
    if (effort_bar_ != 0) pull_bar_ += (2 * effort_bar_ * effort_share()) * record.pull;
    gain_bar_ += pull_bar_.cwiseProduct(record.pull_per_gain).sum();
    for (std::size_t k = 0; k < record.felt.size(); ++k) {
      corrections_bar_[k] += record.felt[k] * pull_bar_;
    }
    // What x and told get by the springs and the dashpots of control, each per unit.
    pull_bar_ -= pull_bar_.rowwise().sum() *
                 (mass_in_plan_ / static_cast<double>(plan_.particles)).transpose();
    Vectors(cotangent_.positions.data(), 3, plan_.particles) -= gain_ * pull_bar_;
    if (!damped()) return;
    std::swap(told_bar_, told_bar_after_);
    told_bar_ = -damping_ * pull_bar_;
  }

  /// What `begin` makes of the launch.
  void tell(const SheetState& start, RolloutGradient& result) {
    Points launch_bar = told_bar_ - 0.5 * told_bar_after_;
    Values launch(launch_bar.data(), launch_bar.data() + launch_bar.size());
    native::begin_back(plan_, start.positions, cotangent_, launch);
    result.launch = in_user_order(launch);
    for (const Points& each : corrections_bar_) {
      result.reference_correction.push_back(
          in_user_order(Values(each.data(), each.data() + each.size())));
    }
    result.gain = gain_bar_;
  }

  const SheetPlan& plan_;
  const Problem& problem_;
  Vector relative_mass_;  ///< in the problem's order
  Vector mass_in_plan_;   ///< the same in the plan's
  double gain_, damping_, damping_per_gain_;

  // Of a step forwards, in the problem's order.
  Points positions_, missing_, lag_, pull_, forces_;

  // The way back, in the plan's order.
  double effort_bar_ = 0;
  double gain_bar_ = 0;
  SheetCotangent cotangent_;
  Points told_bar_, told_bar_after_;  ///< of the velocities told at the step behind, and after it
  Points pull_bar_;
  std::array<Points, correction_powers.size()> corrections_bar_;
  SubstepTape tape_;
  Values turn_, turn_before_;  ///< of the hinges before a step, before a stretch
};

}  // namespace

RolloutGradient fly_back(const SheetPlan& plan, const Problem& problem, const SheetState& start,
                         double gain, const CotangentAt& cotangent_at) {
  return FlightBack(plan, problem, gain).gradient(start, cotangent_at);
}

}  // namespace nuno::native
