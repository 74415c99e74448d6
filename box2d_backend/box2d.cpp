#include <nuno/box2d.h>

#include <nuno/launch.h>
#include <nuno/scene.h>

#include <box2d/box2d.h>
#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>
#include <string_view>

namespace nuno::box2d {
namespace {

using Eigen::Matrix2Xd;
using Eigen::Vector2d;

// Inside, the unit of length is the mean rod, of mass a particle, of time a step: every number that
// Box2D sees is near 1 whatever the scene's scale, and its step of 1 stays out of the formulae.

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

constexpr Index most_particles = 4096;
constexpr double most_steps = 50e6;
constexpr double shortest_rod = 1e-3;  // of the mean rod
constexpr double pair_range = 1.7;     // rad; the inner spring is 0.009 rods long there

// The gap of the end shapes to the native chain at a 4e-5 s step, at the native best gain, over the
// cloth's length: median and 95th percentile of the 27 of 60 random scenes (32 particles, t₀ of 0.4
// to 2 s, three decades of hinge stiffness) where a disturbance grows less than tenfold; and the
// time of one flight:
//     iterations         8                        16                       32
//     t₀/1000   6.9e-5, 4.9e-4, 14 ms    5.9e-5, 3.1e-4, 20 ms    6.1e-5, 3.9e-4,  31 ms
//     t₀/2000   3.5e-5, 4.9e-4, 31 ms    3.5e-5, 3.1e-4, 41 ms    3.6e-5, 3.9e-4,  63 ms
//     t₀/4000   1.8e-5, 4.9e-4, 61 ms    2.6e-5, 2.4e-4, 74 ms    4.2e-5, 3.1e-4, 108 ms
// 60 scenes that had no say in any choice here give 6.0e-5, 4.9e-4 at t₀/2000 and 16 iterations.
// More steps cost centroid: its rounding grows with their number, 5e-5 of the cloth's length at
// t₀/2000, 2e-4 at t₀/4000, 4e-4 at t₀/8000 (s-curve without control, where it is largest).
// The seeded family asks for 1e-3 and 5e-3: t₀/1000 and 8 iterations leave a margin of five, at a
// third of the time of t₀/2000 and 16 (docs/two-engines.md).
constexpr double default_steps = 1000;

float narrow(double value) { return static_cast<float>(value); }
b2Vec2 narrow(const Vector2d& v) { return {narrow(v.x()), narrow(v.y())}; }
Vector2d widen(const b2Vec2& v) { return {static_cast<double>(v.x), static_cast<double>(v.y)}; }

double cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }
Vector2d cross(double w, const Vector2d& r) { return {-w * r.y(), w * r.x()}; }

/// A pose or velocity for every rod [3 × rods]: its centre of mass and its angle.
using Motions = Eigen::Matrix3Xd;

// A rod is two point masses a rod's length ℓ apart, its particles' shares m₁ and m₂: half of an
// inner particle, all of a free end. So, measured from the centre of mass,
//     mass = m₁ + m₂,   left = −ℓ·m₂/mass,   right = ℓ·m₁/mass,   inertia = m₁·m₂·ℓ²/mass,
// and the joined rods are the point masses on segments that do not stretch, since a particle's two
// halves move together. The same shares split the force on a particle.
struct Rod {
  double length = 1;
  double left_share = 0.5;  // m₁
  double right_share = 0.5;
  double mass = 1;
  double left = -0.5;  // abscissa of the particles along the rod
  double right = 0.5;
  double inertia = 0.25;
};

Rod make_rod(double length, bool first, bool last) {
  Rod rod;
  rod.length = length;
  rod.left_share = first ? 1 : 0.5;
  rod.right_share = last ? 1 : 0.5;
  rod.mass = rod.left_share + rod.right_share;
  rod.left = -length * rod.right_share / rod.mass;
  rod.right = length * rod.left_share / rod.mass;
  rod.inertia = rod.left_share * rod.right_share * length * length / rod.mass;
  return rod;
}

// The springs at one hinge, of moment EI·θ/ℓ̄ + ηI·θ̇/ℓ̄.
//
// Soft weld: a b2WeldJoint of that stiffness and damping.
//
// Spring pair: on either side of the rods, a soft b2DistanceJoint from (−a, ±d) on one to (a, ±d)
// on the next, seen from the hinge along each. With φ = θ/2 they are 2·(a·cos φ ∓ d·sin φ) long and
// 2a at rest; springs k store 4k·[a²·(1 − cos φ)² + d²·sin² φ], whose derivative by θ is the moment
//     4k·d²·sin φ·[(a/d)²·(1 − cos φ) + cos φ] = (EI/ℓ̄)·θ·(1 + O(θ⁴))
// for k = EI/(2·ℓ̄·d²) and (a/d)² = 4/3. At tan φ = a/d (θ = 98°) it is 1.6 % too small and the
// inner spring has no length left. Dashpots ηI/(2·ℓ̄·d²) give (ηI/ℓ̄)·θ̇·(1 + sin²φ/3).
struct HingeSpring {
  double stiffness = 0;  // of the weld or of each spring of the pair
  double damping = 0;
  double along = 0;  // a
  double aside = 0;  // d
};

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
struct Plan {
  double h = 0;            // [s]
  double unit_length = 0;  // [m]
  double unit_force = 0;   // [N]
  Hinge hinge = Hinge::soft_weld;
  int velocity_iterations = 0;
  int position_iterations = 0;
  std::vector<Rod> rods;
  std::vector<HingeSpring> hinges;
  double keep = 1;         // s
  double half_kick = 0.5;  // q
  double gravity = 0;
};

constexpr double impulse_weight = 0.75;  // w

Plan make_plan(const Problem& problem, const Options& options, Index steps) {
  const Chain& chain = problem.chain;
  const Index rods = chain.particles() - 1;
  Plan plan;
  plan.h = problem.arrival_time / static_cast<double>(steps);
  plan.unit_length = chain.length / static_cast<double>(rods);
  plan.unit_force = chain.particle_mass * plan.unit_length / (plan.h * plan.h);
  plan.hinge = options.hinge;
  plan.velocity_iterations = options.velocity_iterations;
  plan.position_iterations = options.position_iterations;

  for (Index i = 0; i < rods; ++i) {
    plan.rods.push_back(make_rod(chain.rest_length[i] / plan.unit_length, i == 0, i + 1 == rods));
  }
  const double unit_moment = plan.unit_force * plan.unit_length;
  for (Index i = 0; i + 1 < rods; ++i) {
    HingeSpring hinge;
    hinge.stiffness = chain.cloth.hinge_stiffness / chain.hinge_length[i] / unit_moment;
    hinge.damping = chain.cloth.hinge_damping / chain.hinge_length[i] / (unit_moment * plan.h);
    if (options.hinge == Hinge::spring_pair) {
      hinge.along = chain.hinge_length[i] / plan.unit_length / 2;
      hinge.aside = hinge.along * std::sqrt(0.75);
      hinge.stiffness /= 2 * hinge.aside * hinge.aside;
      hinge.damping /= 2 * hinge.aside * hinge.aside;
    }
    plan.hinges.push_back(hinge);
  }

  const double z = chain.drag_rate() * plan.h;
  plan.half_kick = z > 0 ? std::sinh(z / 2) / z : 0.5;
  plan.keep = std::exp(-z / 2);
  plan.gravity = chain.gravity * plan.h * plan.h / plan.unit_length;
  return plan;
}

class ChainSimulation final : public Simulation {
 public:
  ChainSimulation(const Plan& plan, const Points& positions, const Points& velocities)
      : plan_(plan),
        world_(b2Vec2(0, 0)),
        center_(centroid(positions)),
        pose_(3, rods()),
        velocity_(3, rods()),
        handed_pose_(3, rods()),
        mean_impulse_(2, rods() - 1),
        left_(2, rods()),
        right_(2, rods()),
        positions_(positions),
        velocities_(velocities) {
    const Points x = (positions.colwise() - center_) / plan.unit_length;
    const Points u = without_stretching(positions, velocities) * (plan.h / plan.unit_length);
    Vector2d before(1, 0);
    for (Index i = 0; i < rods(); ++i) {
      const Vector2d along = (x.col(i + 1) - x.col(i)) / rod(i).length;
      const Vector2d spread = (u.col(i + 1) - u.col(i)) / rod(i).length;
      const double angle =
          (i == 0 ? 0 : pose_(2, i - 1)) + std::atan2(cross(before, along), before.dot(along));
      before = along;
      pose_.col(i) << x.col(i) - rod(i).left * along, angle;
      velocity_.col(i) << u.col(i) - rod(i).left * spread, cross(along, spread);
    }
    locate_ends();
    if (within_limits(velocity_)) {
      build_world();
    } else {
      give_up(wild_launch);
    }
  }

  void step(const Points& forces) override {
    if (!failure_.empty()) return;
    if (!apply(forces)) return give_up(wild_force);
    hand_over();
    world_.Step(1, plan_.velocity_iterations, plan_.position_iterations);
    if (!take_over()) return give_up(wild_motion);
    if (!turn_within_range()) return give_up(wild_turn);
    read();
  }

  const Points& positions() const override { return positions_; }
  const Points& velocities() const override { return velocities_; }
  std::string_view failure() const override { return failure_; }

 private:
  static std::size_t index(Index i) { return static_cast<std::size_t>(i); }
  Index rods() const { return static_cast<Index>(plan_.rods.size()); }
  const Rod& rod(Index i) const { return plan_.rods[index(i)]; }

  // Box2D solves joints from the last body of the chain to the first, and at a hinge the joint
  // that was made last comes first: springs, then the revolute joint.
  void build_world() {
    world_.SetGravity({0, narrow(-plan_.half_kick * plan_.gravity)});
    world_.SetAllowSleeping(false);
    world_.SetContinuousPhysics(false);
    for (Index i = 0; i < rods(); ++i) {
      b2BodyDef def;
      def.type = b2_dynamicBody;
      def.allowSleep = false;
      b2Body* body = world_.CreateBody(&def);
      b2MassData mass;
      mass.mass = narrow(rod(i).mass);
      mass.center.SetZero();
      mass.I = narrow(rod(i).inertia);
      body->SetMassData(&mass);
      bodies_.push_back(body);
      if (i > 0) joints_.push_back(join(index(i - 1)));
    }
  }

  // A soft joint's impulse over Box2D's step of 1 is −k·(C + Ċ) − c·Ċ: the spring is evaluated
  // where the step ends, and its k·Ċ is a damping that nobody asked for. c = c₀ − (1 − ε)·k takes
  // it out; ε, since c = −k means a rigid joint to Box2D. Half a kick, so half the spring: q·k.
  b2Joint* join(std::size_t i) {
    constexpr double epsilon = 1.0 / 1024;
    constexpr double nothing = 1e-20;  // no moment to speak of, and its reciprocal is finite
    const HingeSpring& hinge = plan_.hinges[i];
    const bool has_spring = std::max(hinge.stiffness, hinge.damping) > nothing;
    // A joint of no stiffness would be rigid: a lone dashpot gets a spring for form's sake.
    const double k = plan_.half_kick * std::max(hinge.stiffness, nothing);
    const double c = plan_.half_kick * hinge.damping - (1 - epsilon) * k;
    const double end = plan_.rods[i].right;
    const double start = plan_.rods[i + 1].left;

    if (has_spring && plan_.hinge == Hinge::soft_weld) {
      b2WeldJointDef weld;
      weld.bodyA = bodies_[i];
      weld.bodyB = bodies_[i + 1];
      weld.localAnchorA = {narrow(end), 0};
      weld.localAnchorB = {narrow(start), 0};
      weld.stiffness = narrow(k);
      weld.damping = narrow(c);
      return world_.CreateJoint(&weld);
    }

    b2RevoluteJointDef pivot;
    pivot.bodyA = bodies_[i];
    pivot.bodyB = bodies_[i + 1];
    pivot.localAnchorA = {narrow(end), 0};
    pivot.localAnchorB = {narrow(start), 0};
    b2Joint* revolute = world_.CreateJoint(&pivot);
    if (!has_spring) return revolute;
    for (const double side : {hinge.aside, -hinge.aside}) {
      b2DistanceJointDef spring;
      spring.bodyA = bodies_[i];
      spring.bodyB = bodies_[i + 1];
      spring.localAnchorA = {narrow(end - hinge.along), narrow(side)};
      spring.localAnchorB = {narrow(start + hinge.along), narrow(side)};
      spring.length = narrow(2 * hinge.along);
      spring.maxLength = 2 * spring.length;  // the outer spring never gets past 1.4 of it
      spring.stiffness = narrow(k);
      spring.damping = narrow(c);
      world_.CreateJoint(&spring);
    }
    return revolute;
  }

  bool apply(const Points& forces) {
    const double scale = plan_.half_kick / plan_.unit_force;
    if (!((scale * forces).cwiseAbs().maxCoeff() < largest_force)) return false;
    if (!forces.allFinite()) return false;  // the maximum may have passed over a NaN
    for (Index i = 0; i < rods(); ++i) {
      const Vector2d left = scale * rod(i).left_share * forces.col(i);
      const Vector2d right = scale * rod(i).right_share * forces.col(i + 1);
      const double torque = cross(left_.col(i), left) + cross(right_.col(i), right);
      bodies_[index(i)]->ApplyForceToCenter(narrow(left + right), false);
      bodies_[index(i)]->ApplyTorque(narrow(torque), false);
    }
    return true;
  }

  void hand_over() {
    handed_pose_ = pose_.cast<float>();
    for (Index i = 0; i < rods(); ++i) {
      b2Body& body = *bodies_[index(i)];
      body.SetTransform({handed_pose_(0, i), handed_pose_(1, i)}, handed_pose_(2, i));
      body.SetLinearVelocity(narrow(plan_.keep * velocity_.col(i).head<2>()));
      body.SetAngularVelocity(narrow(plan_.keep * velocity_(2, i)));
    }
  }

  bool take_over() {
    Motions solved(3, rods());      // v
    Motions correction(3, rods());  // of the position solver, after x + h·v as Box2D rounds it
    for (Index i = 0; i < rods(); ++i) {
      const b2Vec2& v = bodies_[index(i)]->GetLinearVelocity();
      const Eigen::Vector3f motion(v.x, v.y, bodies_[index(i)]->GetAngularVelocity());
      const b2Vec2& x = bodies_[index(i)]->GetPosition();
      const Eigen::Vector3f pose(x.x, x.y, bodies_[index(i)]->GetAngle());
      const Eigen::Vector3f moved = handed_pose_.col(i) + motion;
      solved.col(i) = motion.cast<double>();
      correction.col(i) = (pose - moved).cast<double>();
    }
    if (!within_limits(solved)) return false;

    velocity_ = first_ ? solved : Motions(2 * solved - plan_.keep * velocity_);  // to become u'
    for (Index i = 0; i + 1 < rods(); ++i) {
      const Vector2d impulse = widen(joints_[index(i)]->GetReactionForce(1));
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
    if (!first_) velocity_ *= plan_.keep;
    first_ = false;

    pose_ += velocity_ + correction;
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
      if (bent && plan_.hinge == Hinge::spring_pair) return false;
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
    positions_ = (plan_.unit_length * positions_).colwise() + center_;
    velocities_ *= plan_.unit_length / plan_.h;

    const Vector2d moved = mass_center(pose_);
    center_ += plan_.unit_length * moved;
    pose_.topRows<2>().colwise() -= moved;
  }

  /// Box2D sees nothing of this cloth from now on: a bad number would end the process there.
  void give_up(std::string_view reason) {
    failure_ = reason;
    positions_.setConstant(std::numeric_limits<double>::quiet_NaN());
    velocities_.setConstant(std::numeric_limits<double>::quiet_NaN());
  }

  const Plan& plan_;
  b2World world_;
  std::vector<b2Body*> bodies_;   // of the rods
  std::vector<b2Joint*> joints_;  // that hold the hinges together: revolute or weld
  Vector2d center_;               // [m], where poses have their origin
  Motions pose_;                  // x
  Motions velocity_;              // u
  Eigen::Matrix3Xf handed_pose_;
  Matrix2Xd mean_impulse_;  // λ̄ of every hinge
  Matrix2Xd left_, right_;  // the rods' ends from their centres
  Points positions_, velocities_;
  std::string_view failure_;  // empty: Box2D flies this cloth
  bool first_ = true;
};

class ChainBackend final : public Backend {
 public:
  ChainBackend(const Problem& problem, const Options& options, Index steps)
      : Backend(problem, steps), plan_(make_plan(problem, options, steps)) {}

  std::string_view name() const override { return "box2d"; }

  double largest_gain() const override {
    // √(α/m)·h ≤ 0.2 rad: the control's own oscillation takes 30 steps or more.
    const double h = time_step();
    return 0.04 * problem().chain.particle_mass / (h * h);
  }

  // v = s·u − q·g and u' = s·(v − q·g).
  DragRecurrence drag_recurrence() const override {
    const double s = plan_.keep;
    const double q = plan_.half_kick * plan_.h;
    return {plan_.h, s, q, s * s, 2 * s * q};
  }

  std::unique_ptr<Simulation> start(const Points& positions,
                                    const Points& velocities) const override {
    return std::make_unique<ChainSimulation>(plan_, positions, velocities);
  }

  // A hundred times the rounding that a flight collects in single precision.
  double smallest_disturbance() const override { return 1e-4; }

 private:
  Plan plan_;
};

/// A step that the engine can take, and what asked for it.
struct StepLimit {
  double h = 0;  // [s]
  const char* field = "";
  double value = 0;
};

/// The hinges' springs are explicit, of highest frequency ω² = 16·k/(m·ℓ²) for a moment k·θ on
/// particles of a straight chain, and their dashpots of rate c in its place. h²ω² + 2hc ≤ ½ stays
/// well below RATTLE's own limit of 4, since λ̄ lags: on the scenes above at t₀/1000 the 95th
/// percentile of the gap is 3e-4, with 1 in place of ½ 1.5e-3, with 2 5.6e-3.
StepLimit hinge_limit(const Chain& chain) {
  constexpr double limit = 0.5;
  const double shortest = chain.rest_length.minCoeff();
  const double per_hinge =
      16 / (chain.hinge_length.minCoeff() * shortest * shortest * chain.particle_mass);
  const double squared_frequency = per_hinge * chain.cloth.hinge_stiffness;
  const double rate = per_hinge * chain.cloth.hinge_damping;
  if (chain.cloth.hinge_stiffness == 0 && chain.cloth.hinge_damping == 0) {
    return {std::numeric_limits<double>::infinity(), "", 0};
  }
  const double h = limit / (rate + std::sqrt(rate * rate + limit * squared_frequency));
  if (rate * rate > squared_frequency)
    return {h, "/cloth/hinge_damping", chain.cloth.hinge_damping};
  return {h, "/cloth/hinge_stiffness", chain.cloth.hinge_stiffness};
}

/// A free flight by no more than a rod per step, half of Box2D's limit.
StepLimit flight_limit(const Problem& problem) {
  const Chain& chain = problem.chain;
  const double rod = chain.length / static_cast<double>(chain.particles() - 1);
  const Points launch = ballistic_launch(chain.initial, problem.target, problem.arrival_time,
                                         chain.gravity, chain.drag_rate());
  const double fastest = launch.colwise().norm().maxCoeff() + chain.gravity * problem.arrival_time;
  return {rod / fastest, "/arrival_time", problem.arrival_time};
}

StepLimit drag_limit(const Chain& chain) {
  return {0.25 / chain.drag_rate(), "/cloth/air_drag", chain.cloth.air_drag};
}

Index count_steps(const Problem& problem, std::optional<double> time_step) {
  StepLimit tightest{problem.arrival_time / default_steps, "/arrival_time", problem.arrival_time};
  if (time_step) tightest = {*time_step, "/time_step", *time_step};
  if (!(tightest.h > 0)) {
    throw InputError(fmt::format("/time_step: {} is not > 0", tightest.value));
  }
  for (const StepLimit& limit :
       {hinge_limit(problem.chain), flight_limit(problem), drag_limit(problem.chain)}) {
    if (!(tightest.h <= limit.h)) tightest = limit;
  }
  const double steps = std::ceil(problem.arrival_time / tightest.h * (1 - 1e-12));
  if (!(steps <= most_steps)) {
    throw InputError(fmt::format("{}: {} takes {:.3g} steps on box2d, which is not <= {:.0f}",
                                 tightest.field, tightest.value, steps, most_steps));
  }
  return std::max<Index>(1, static_cast<Index>(steps));
}

void require_within_range(const Chain& chain, Hinge form) {
  if (chain.particles() > most_particles) {
    throw InputError(fmt::format("/particles: {} is not <= {}, the longest chain on box2d",
                                 chain.particles(), most_particles));
  }
  const double relative = chain.rest_length.minCoeff() / chain.rest_length.mean();
  if (!(relative >= shortest_rod)) {
    throw InputError(
        fmt::format("/initial: a segment of {:.2g} of the mean length is not >= {}, the shortest "
                    "rod on box2d",
                    relative, shortest_rod));
  }
  if (form != Hinge::spring_pair) return;
  for (Index i = 0; i + 2 < chain.particles(); ++i) {
    const Vector2d before = chain.initial.col(i + 1) - chain.initial.col(i);
    const Vector2d after = chain.initial.col(i + 2) - chain.initial.col(i + 1);
    const double angle = std::abs(std::atan2(cross(before, after), before.dot(after)));
    if (!(angle <= pair_range)) {
      throw InputError(fmt::format(
          "/initial: a turning angle of {:.3g} rad at particle {} is not <= {}, the range of the "
          "spring pair on box2d",
          angle, i + 1, pair_range));
    }
  }
}

}  // namespace

std::unique_ptr<Backend> make_backend(const Problem& problem, const Options& options) {
  assert(options.velocity_iterations > 0 && options.position_iterations > 0);
  require_within_range(problem.chain, options.hinge);
  return std::make_unique<ChainBackend>(problem, options, count_steps(problem, options.time_step));
}

}  // namespace nuno::box2d
