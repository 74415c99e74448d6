#include "chain_simulation.h"

#include <nuno/launch.h>

#include "rod_world.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <string_view>

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
// λ̄ ← λ̄ + w·(λ − λ̄): RATTLE has λ̄ = λ, w = 1, but then nothing takes away a velocity that the
// joints forbid; each step multiplies it by 1 − 2w. J·(λ̄ − λ) itself is cut away by the next P.
//
// Box2D's position solver closes what stays open of the joints, and its corrections are taken over.
//
// Poses and velocities are kept in double precision, poses about the centroid: the flight is long
// and the cloth small. Nothing here knows where the centroid should be: it flies by the velocities
// that Box2D solves, and misses by their rounding.
Scheme make_scheme(const RodChain& chain, const Options& options) {
  const double z = chain.drag_rate;
  Scheme scheme;
  scheme.keep = std::exp(-z / 2);
  scheme.half_kick = z > 0 ? std::sinh(z / 2) / z : 0.5;
  scheme.velocity_iterations = options.velocity_iterations;
  scheme.position_iterations = options.position_iterations;
  return scheme;
}

namespace {

using Eigen::Matrix2Xd;
using Eigen::Vector2d;

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
  ChainSimulation(const RodChain& chain, const Scheme& scheme, const Points& positions,
                  const Points& velocities)
      : chain_(chain),
        scheme_(scheme),
        center_(centroid(positions)),
        pose_(3, rods()),
        velocity_(3, rods()),
        mean_impulse_(2, rods() - 1),
        left_(2, rods()),
        right_(2, rods()),
        positions_(positions),
        velocities_(velocities) {
    const Points x = (positions.colwise() - center_) / chain_.unit_length;
    const Points u = without_stretching(positions, velocities) * (chain_.h / chain_.unit_length);
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
    if (within_limits(velocity_)) {
      world_.emplace(chain_, scheme_.half_kick);
    } else {
      give_up(wild_launch);
    }
  }

  void step(const Points& forces) override {
    if (!failure_.empty()) return;
    if (!push(forces)) return give_up(wild_force);
    const RodWorld::Step solved = world_->step(
        pose_, scheme_.keep * velocity_, scheme_.velocity_iterations, scheme_.position_iterations);
    if (!take_over(solved)) return give_up(wild_motion);
    if (!turn_within_range()) return give_up(wild_turn);
    read();
  }

  const Points& positions() const override { return positions_; }
  const Points& velocities() const override { return velocities_; }
  std::string_view failure() const override { return failure_; }

 private:
  static std::size_t index(Index i) { return static_cast<std::size_t>(i); }
  Index rods() const { return static_cast<Index>(chain_.rods.size()); }
  const Rod& rod(Index i) const { return chain_.rods[index(i)]; }

  bool push(const Points& forces) {
    const double scale = scheme_.half_kick / chain_.unit_force;
    if (!((scale * forces).cwiseAbs().maxCoeff() < largest_force)) return false;
    if (!forces.allFinite()) return false;  // the maximum may have passed over a NaN
    for (Index i = 0; i < rods(); ++i) {
      const Vector2d left = scale * rod(i).left_share * forces.col(i);
      const Vector2d right = scale * rod(i).right_share * forces.col(i + 1);
      const double torque = cross(left_.col(i), left) + cross(right_.col(i), right);
      world_->push(i, left + right, torque);
    }
    return true;
  }

  bool take_over(const RodWorld::Step& solved) {
    if (!within_limits(solved.velocities)) return false;

    velocity_ = first_ ? solved.velocities
                       : Motions(2 * solved.velocities - scheme_.keep * velocity_);  // to become u'
    for (Index i = 0; i + 1 < rods(); ++i) {
      const Vector2d impulse = solved.impulses.col(i);
      if (first_) {
        mean_impulse_.col(i) = impulse;
        continue;
      }
      const Vector2d change = (1 - impulse_weight) * (mean_impulse_.col(i) - impulse);
      mean_impulse_.col(i) = impulse + change;
      velocity_.col(i).head<2>() -= change / rod(i).mass;
      velocity_(2, i) -= cross(right_.col(i), change) / rod(i).inertia;
      velocity_.col(i + 1).head<2>() += change / rod(i + 1).mass;
      velocity_(2, i + 1) += cross(left_.col(i + 1), change) / rod(i + 1).inertia;
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
    positions_ = (chain_.unit_length * positions_).colwise() + center_;
    velocities_ *= chain_.unit_length / chain_.h;

    const Vector2d moved = mass_center(pose_);
    center_ += chain_.unit_length * moved;
    pose_.topRows<2>().colwise() -= moved;
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
  Vector2d center_;                // [m], where poses have their origin
  Motions pose_;                   // x
  Motions velocity_;               // u
  Matrix2Xd mean_impulse_;         // λ̄ of every hinge
  Matrix2Xd left_, right_;         // the rods' ends from their centres
  Points positions_, velocities_;
  std::string_view failure_;  // empty: Box2D flies this cloth
  bool first_ = true;
};

}  // namespace

std::unique_ptr<Simulation> make_simulation(const RodChain& chain, const Scheme& scheme,
                                            const Points& positions, const Points& velocities) {
  return std::make_unique<ChainSimulation>(chain, scheme, positions, velocities);
}

}  // namespace nuno::box2d
