#include "chain_simulation.h"

#include <nuno/launch.h>

#include "joint_impulses.h"
#include "rod_world.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <string_view>
#include <utility>

namespace nuno::box2d {

// One step is RATTLE's (Andersen 1983), second order in h, with Box2D as its solver of joints and
// springs. Box2D's own step v ← P(v + h·a), x ← x + h·v cuts the velocity down to what the joints
// allow where the step begins (P, by impulses J·λ), so it loses each time what has turned out of
// that since the last: an error of first order, twenty times as large as all others. Here Box2D
// takes half a kick, which gives the velocity at the very moment of x, and the same half again,
// impulses too, follows outside:
//     v  = s·u + q·a + J·λ         u: mean velocity over the last step
//     u' = s·(v + q·a + J·λ̄)       (the first step starts at v₀, not half a step before: u' = v)
//     x' = x + h·u'
// s = e^(−κh/2) and q = sinh(κh/2)/κ make drag and a constant force exact. s is not left to Box2D's
// damping: 1 − s has only three digits in single precision, for a drag of 1e-4 per step.
// The hinges' springs are in P. Box2D evaluates a soft joint where the step ends, k·(C + Ċ); a
// moment k·s·u outside makes that k·(C + v − u), the mean of the angles before and after the step:
//     h²ω²  →  h²ω²/(1 + h²ω²/2) < 2
// below RATTLE's limit of 4 at every stiffness and with room for λ̄, which lags. It is of second
// order and damps nothing; the mean of three, (θ₋ + 2θ + θ₊)/4, comes up to that limit and bursts.
//
// Where dashpots are too rigid for iterations, the impulses of joints and hinges are solved for,
// all at once (see joint_impulses.h). Box2D is given them as forces and has the joints alone, which
// add what is missing.
//
// λ̄ ← λ̄ + w·(λ − λ̄): RATTLE has λ̄ = λ, w = 1, but then nothing takes away a velocity that the
// joints forbid; each step multiplies it by 1 − 2w. J·(λ̄ − λ) itself is cut away by the next P.
// A rigid dashpot forbids a turning as a joint does, and its moment is treated like λ. A spring
// does not stand the lag from h²ω² = 6hc on; where joints are solved for, hc is the larger.
//
// Box2D's position solver closes what stays open of the joints, and its corrections are taken over.
//
// The rods fly about their mass centre, see mass_center_flight.h: without gravity, and under what
// is left of the forces when their mean is taken off. Poses and velocities are kept in double
// precision, and what rounding adds to their mass centre's is taken off.
Scheme make_scheme(const RodChain& chain, const Options& options) {
  const double z = chain.drag_rate;
  Scheme scheme;
  scheme.keep = std::exp(-z / 2);
  scheme.half_kick = z > 0 ? std::sinh(z / 2) / z : 0.5;
  // Each iteration takes away what is the faster gone the softer the springs: with 2/3 of h²ω² + hc
  // more, gaps and strains are those of converged impulses to a tenth, from 15 to 600 of it; with
  // a third, a stiff cloth (150) bursts.
  const double more = chain.solves_joints ? 0 : 2.0 / 3 * chain.hinge_rigidity;
  scheme.velocity_iterations = options.velocity_iterations + static_cast<int>(more);
  scheme.position_iterations = options.position_iterations;
  return scheme;
}

namespace {

using Eigen::Matrix2Xd;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double impulse_weight = 0.75;  // w

// Past 2 units or π/2 rad per step Box2D silently moves a body less than its velocity says.
constexpr double largest_translation = 1.9;  // rods per step
constexpr double largest_rotation = 1.5;     // rad per step
constexpr double largest_force = 1e3;        // breaks those limits at once, and is no trouble yet

// Why a flight ends before its time.
constexpr std::string_view wild_launch =
    "a rod is launched faster than Box2D moves it: two lengths or a quarter turn per step";
constexpr std::string_view wild_force = "a force is larger than Box2D can take in one step";
constexpr std::string_view wild_motion =
    "a rod gets faster than Box2D moves it: two lengths or a quarter turn per step";
constexpr std::string_view wild_turn = "a hinge turns further than its pair of springs reaches";

double cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }
Vector2d cross(double w, const Vector2d& r) { return {-w * r.y(), w * r.x()}; }

class ChainSimulation final : public Simulation {
 public:
  ChainSimulation(const RodChain& chain, const Scheme& scheme, MassCenterFlight center,
                  const Points& positions, const Points& velocities)
      : chain_(chain),
        scheme_(scheme),
        center_(std::move(center)),
        pose_(3, rods()),
        velocity_(3, rods()),
        mean_impulse_(3, rods() - 1),
        left_(2, rods()),
        right_(2, rods()),
        positions_(positions),
        velocities_(velocities) {
    const Points x = shape_of(positions) / chain_.unit_length;
    const Points u =
        shape_of(without_stretching(positions, velocities)) * (chain_.h / chain_.unit_length);
    Vector2d before(1, 0);
    for (Index i = 0; i < rods(); ++i) {
      const Vector2d along = (x.col(i + 1) - x.col(i)) / rod(i).length;
      const Vector2d spread = (u.col(i + 1) - u.col(i)) / rod(i).length;
      const double angle = (i == 0 ? 0 : pose_(2, i - 1)) + turning_angle(before, along);
      before = along;
      pose_.col(i) << x.col(i) - rod(i).left * along, angle;
      velocity_.col(i) << u.col(i) - rod(i).left * spread, cross(along, spread);
    }
    locate_ends();
    if (chain_.solves_joints) solver_.emplace(chain_, scheme_.half_kick);
    if (within_limits(velocity_)) {
      world_.emplace(chain_, scheme_.half_kick);
    } else {
      give_up(wild_launch);
    }
  }

  void step(const Points& forces) override {
    if (!failure_.empty()) return;
    const Vector2d mean_force = centroid(forces);
    if (!push(forces.colwise() - mean_force)) return give_up(wild_force);
    const RodWorld::Step solved = world_->step(
        pose_, scheme_.keep * velocity_, scheme_.velocity_iterations, scheme_.position_iterations);
    if (!take_over(solved)) return give_up(wild_motion);
    if (!turn_within_range()) return give_up(wild_turn);
    center_.step(mean_force);
    read();
  }

  const Points& positions() const override { return positions_; }
  const Points& velocities() const override { return velocities_; }
  std::string_view failure() const override { return failure_; }

 private:
  static std::size_t index(Index i) { return static_cast<std::size_t>(i); }
  Index rods() const { return static_cast<Index>(chain_.rods.size()); }
  const Rod& rod(Index i) const { return chain_.rods[index(i)]; }

  /// Hands the rods what acts on them besides Box2D's joints and springs; false if that is too
  /// much.
  bool push(const Points& forces) {
    Motions pushes = pushes_of(forces);
    if (solver_) join(pushes);
    if (!(pushes.array().abs() < largest_force).all()) return false;  // or one is NaN
    for (Index i = 0; i < rods(); ++i) world_->push(i, pushes.col(i).head<2>(), pushes(2, i));
    if (solver_) return true;
    const Vector moments = look_back();
    for (Index i = 0; i + 1 < rods(); ++i) {
      world_->push(i, {0, 0}, -moments[i]);
      world_->push(i + 1, {0, 0}, moments[i]);
    }
    return true;
  }

  /// Force and torque on every rod over half a kick.
  Motions pushes_of(const Points& forces) const {
    const double scale = scheme_.half_kick / chain_.unit_force;
    Motions pushes(3, rods());
    for (Index i = 0; i < rods(); ++i) {
      const Vector2d left = scale * rod(i).left_share * forces.col(i);
      const Vector2d right = scale * rod(i).right_share * forces.col(i + 1);
      pushes.col(i) << left + right, cross(left_.col(i), left) + cross(right_.col(i), right);
    }
    return pushes;
  }

  /// Solves for the joints and adds what they give.
  void join(Motions& pushes) {
    Motions free = scheme_.keep * velocity_;
    for (Index i = 0; i < rods(); ++i) {
      free.col(i).head<2>() += pushes.col(i).head<2>() / rod(i).mass;
      free(2, i) += pushes(2, i) / rod(i).inertia;
    }
    solved_ = solver_->solve(turns(pose_), turning(), free, left_, right_);
    for (Index i = 0; i + 1 < rods(); ++i) {
      pushes.col(i) -= at(right_.col(i), solved_.col(i));
      pushes.col(i + 1) += at(left_.col(i + 1), solved_.col(i));
    }
  }

  /// What an impulse at r from a rod's centre does to the rod.
  static Vector3d at(const Vector2d& r, const Vector3d& impulse) {
    const Vector2d force = impulse.head<2>();
    return {force.x(), force.y(), cross(r, force) + impulse[2]};
  }

  /// From one rod's angle to the next one's.
  static Vector turns(const Motions& motions) {
    const Index hinges = motions.cols() - 1;
    return (motions.row(2).tail(hinges) - motions.row(2).head(hinges)).transpose();
  }

  /// s·u of the hinges.
  Vector turning() const { return scheme_.keep * turns(velocity_); }

  /// k·s·u of the hinges, the moments that take their springs back from where the step ends.
  Vector look_back() const {
    Vector moments = turning();
    for (Index i = 0; i < moments.size(); ++i) {
      const HingeSpring& hinge = chain_.hinges[index(i)];
      double squared_arm = 1;  // Σ (dC/dθ)², see rod_chain.cpp
      if (chain_.hinge == Hinge::spring_pair) {
        const double phi = (pose_(2, i + 1) - pose_(2, i)) / 2;
        const double along = hinge.along * std::sin(phi), aside = hinge.aside * std::cos(phi);
        squared_arm = 2 * (along * along + aside * aside);
      }
      moments[i] = scheme_.half_kick * hinge.stiffness * squared_arm * moments[i];
    }
    return moments;
  }

  bool take_over(const RodWorld::Step& solved) {
    if (!within_limits(solved.velocities)) return false;

    velocity_ = first_ ? solved.velocities
                       : Motions(2 * solved.velocities - scheme_.keep * velocity_);  // to become u'
    for (Index i = 0; i + 1 < rods(); ++i) {
      Vector3d impulse(solved.impulses(0, i), solved.impulses(1, i), 0);
      if (solver_) impulse += solved_.col(i);
      if (first_) {
        mean_impulse_.col(i) = impulse;
        continue;
      }
      const Vector3d change = (1 - impulse_weight) * (mean_impulse_.col(i) - impulse);
      mean_impulse_.col(i) = impulse + change;
      const Vector3d before = at(right_.col(i), change), after = at(left_.col(i + 1), change);
      velocity_.col(i).head<2>() -= before.head<2>() / rod(i).mass;
      velocity_(2, i) -= before[2] / rod(i).inertia;
      velocity_.col(i + 1).head<2>() += after.head<2>() / rod(i + 1).mass;
      velocity_(2, i + 1) += after[2] / rod(i + 1).inertia;
    }
    if (!first_) velocity_ *= scheme_.keep;
    first_ = false;

    pose_ += velocity_ + solved.corrections;
    return within_limits(velocity_);
  }

  // The hinges' law knows θ in (−π, π] only: a hinge that turns through π snaps over.
  bool turn_within_range() {
    double turns = 0;
    const auto whole_turns = [](double angle) {
      return std::round(angle / (2 * std::numbers::pi)) * 2 * std::numbers::pi;
    };
    double before = 0;  // so that the first rod's own angle stays small
    for (Index i = 0; i < rods(); ++i) {
      const double angle = pose_(2, i);
      const double turn = angle - before;
      before = angle;
      turns += whole_turns(turn);
      pose_(2, i) = angle - turns;
      const bool bent = i > 0 && std::abs(turn - whole_turns(turn)) > pair_range;
      if (bent && chain_.hinge == Hinge::spring_pair) return false;
    }
    return true;
  }

  static bool within_limits(const Motions& motions) {
    return motions.allFinite() &&
           motions.topRows<2>().colwise().norm().maxCoeff() < largest_translation &&
           motions.row(2).cwiseAbs().maxCoeff() < largest_rotation;
  }

  Vector2d mass_center(const Motions& motions) const {
    Vector2d sum(0, 0);
    for (Index i = 0; i < rods(); ++i) sum += rod(i).mass * motions.col(i).head<2>();
    return sum / static_cast<double>(rods() + 1);
  }

  /// Takes off what rounding has added to the motion of the mass centre.
  void recenter() {
    const Vector2d moved = mass_center(pose_), drift = mass_center(velocity_);
    pose_.topRows<2>().colwise() -= moved;
    velocity_.topRows<2>().colwise() -= drift;
  }

  void locate_ends() {
    for (Index i = 0; i < rods(); ++i) {
      const Vector2d along(std::cos(pose_(2, i)), std::sin(pose_(2, i)));
      left_.col(i) = rod(i).left * along;
      right_.col(i) = rod(i).right * along;
    }
  }

  // A particle is where the mean of its halves is. An end turns by ω from r to r' within a step, a
  // chord of 2·tan(ω/2)·(r + r')/2 turned by a right angle; differences of positions would say the
  // same with the roundings of two poses, over h.
  void read() {
    recenter();
    const Matrix2Xd left_before = left_;
    const Matrix2Xd right_before = right_;
    locate_ends();
    positions_.setZero();
    velocities_.setZero();
    for (Index i = 0; i < rods(); ++i) {
      const double left = rod(i).left_share;
      const double right = rod(i).right_share;
      const auto x = pose_.col(i).head<2>();
      const auto u = velocity_.col(i).head<2>();
      const double turn = std::tan(velocity_(2, i) / 2);
      positions_.col(i) += left * (x + left_.col(i));
      positions_.col(i + 1) += right * (x + right_.col(i));
      velocities_.col(i) += left * (u + cross(turn, left_.col(i) + left_before.col(i)));
      velocities_.col(i + 1) += right * (u + cross(turn, right_.col(i) + right_before.col(i)));
    }
    const double unit_velocity = chain_.unit_length / chain_.h;
    positions_ = (chain_.unit_length * positions_).colwise() + center_.position();
    velocities_ = (unit_velocity * shape_of(velocities_)).colwise() + center_.velocity();
  }

  /// Box2D sees nothing of this cloth from now on: a bad number would end the process there.
  void give_up(std::string_view reason) {
    failure_ = reason;
    positions_.setConstant(std::numeric_limits<double>::quiet_NaN());
    velocities_.setConstant(std::numeric_limits<double>::quiet_NaN());
  }

  const RodChain& chain_;
  const Scheme& scheme_;
  std::optional<RodWorld> world_;  // none for a launch that Box2D could not take
  MassCenterFlight center_;
  Motions pose_;                         // x
  Motions velocity_;                     // u
  std::optional<JointImpulses> solver_;  // of hinges that are too rigid for Box2D
  Motions solved_;                       // its impulses in this step
  Motions mean_impulse_;    // λ̄ of every joint, with its moment where it is solved for
  Matrix2Xd left_, right_;  // the rods' ends from their centres
  Points positions_, velocities_;
  std::string_view failure_;  // empty: Box2D flies this cloth
  bool first_ = true;
};

}  // namespace

std::unique_ptr<Simulation> make_simulation(const RodChain& chain, const Scheme& scheme,
                                            const MassCenterFlight& center, const Points& positions,
                                            const Points& velocities) {
  return std::make_unique<ChainSimulation>(chain, scheme, center, positions, velocities);
}

}  // namespace nuno::box2d
