// Box2D's b2Rope: position-based dynamics in single precision. Its default models (PBD) and those
// of the rope in Box2D's own testbed (XPBD), both with that rope's 8 iterations and with the
// stiffness of this chain; and the cheapest that there is, 1 iteration, for what it says about
// accuracy.

#include <box2d/b2_draw.h>
#include <box2d/b2_rope.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "peers.h"

namespace nuno::bench {
namespace {

/// The only way to read a rope's positions is to have it drawn.
class PointCollector final : public b2Draw {
 public:
  explicit PointCollector(Index count) : points_(2, count) {}

  void DrawPoint(const b2Vec2& p, float, const b2Color&) override {
    points_.col(next_++) << static_cast<double>(p.x), static_cast<double>(p.y);
  }
  void DrawPolygon(const b2Vec2*, int32, const b2Color&) override {}
  void DrawSolidPolygon(const b2Vec2*, int32, const b2Color&) override {}
  void DrawCircle(const b2Vec2&, float, const b2Color&) override {}
  void DrawSolidCircle(const b2Vec2&, float, const b2Vec2&, const b2Color&) override {}
  void DrawSegment(const b2Vec2&, const b2Vec2&, const b2Color&) override {}
  void DrawTransform(const b2Transform&) override {}

  const Points& points() const { return points_; }

 private:
  Points points_;
  Index next_ = 0;
};

struct Variant {
  bool xpbd = false;
  int iterations = 0;
};

Points fly(const Problem& problem, Index steps, const Variant& variant) {
  const Chain& chain = problem.chain();
  const auto n = static_cast<std::size_t>(chain.particles());
  std::vector<b2Vec2> vertices(n);
  std::vector<float> masses(n, static_cast<float>(chain.particle_mass));
  for (std::size_t i = 0; i < n; ++i) {
    const auto column = static_cast<Index>(i);
    vertices[i].Set(static_cast<float>(chain.initial(0, column)),
                    static_cast<float>(chain.initial(1, column)));
  }
  const double h = problem.arrival_time / static_cast<double>(steps);
  const double length = chain.rest_length.mean();
  // The effective masses of b2Rope's two constraints in a straight rope.
  const double stretch_mass = chain.particle_mass / 2;
  const double bend_mass = chain.particle_mass * length * length / 6;
  const double stretch_spring = chain.material.stretch_stiffness / length;
  const double bend_spring = chain.material.hinge_stiffness / length;
  b2RopeDef def;
  def.vertices = vertices.data();
  def.count = static_cast<int32>(n);
  def.masses = masses.data();
  def.gravity.Set(0, -static_cast<float>(chain.gravity));
  if (variant.xpbd) {
    const auto hertz = [](double spring, double mass) {
      return static_cast<float>(std::sqrt(spring / mass) / (2 * std::numbers::pi));
    };
    def.tuning.stretchingModel = b2_xpbdStretchingModel;
    def.tuning.stretchHertz = hertz(stretch_spring, stretch_mass);
    def.tuning.stretchDamping = 0;
    def.tuning.bendingModel = b2_xpbdAngleBendingModel;
    def.tuning.bendHertz = hertz(bend_spring, bend_mass);
    def.tuning.bendDamping = 0;
  } else {
    // Each iteration takes the share k of the angle; all of them what the spring takes in a step.
    const double taken = std::min(1.0, bend_spring / bend_mass * h * h);
    def.tuning.bendStiffness =
        static_cast<float>(1 - std::pow(1 - taken, 1.0 / variant.iterations));
  }
  b2Rope rope;
  rope.Create(def);
  for (Index step = 0; step < steps; ++step) {
    rope.Step(static_cast<float>(h), variant.iterations, b2Vec2(0, 0));
  }
  PointCollector collector(chain.particles());
  rope.Draw(&collector);
  return collector.points();
}

}  // namespace

std::vector<Peer> b2rope_peers(const Problem& problem, Index steps) {
  std::vector<Peer> result;
  for (const Variant& variant : {Variant{false, 8}, Variant{true, 8}, Variant{true, 1}}) {
    result.push_back({fmt::format("b2Rope, {}, {} iteration{}", variant.xpbd ? "XPBD" : "PBD",
                                  variant.iterations, variant.iterations == 1 ? "" : "s"),
                      0.05, [&problem, steps, variant] { return fly(problem, steps, variant); }});
  }
  return result;
}

}  // namespace nuno::bench
