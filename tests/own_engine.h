#pragma once

#include <nuno/backend.h>

#include <cmath>
#include <memory>

// An engine of one's own, as short as one can write it: semi-implicit Euler on explicit springs.
// It knows no dashpots at hinges, and flies chains only.
namespace nuno::own {

struct Flight : Simulation {
  Flight(const Chain& flown, double step, const Points& positions, const Points& velocities)
      : chain(flown), h(step), x(positions), v(velocities) {}

  void step(const Points& forces) override {
    const ChainMaterial& cloth = chain.material;
    const Index segments = chain.particles() - 1;
    Points f = forces, along(2, segments);
    Vector length(segments);
    for (Index i = 0; i < segments; ++i) {  // (EA·(l − ℓ) + ηA·l̇)/ℓ
      const Eigen::Vector2d span = x.col(i + 1) - x.col(i), rate = v.col(i + 1) - v.col(i);
      length[i] = span.norm();
      along.col(i) = span / length[i];
      const double tension = (cloth.stretch_stiffness * (length[i] - chain.rest_length[i]) +
                              cloth.stretch_damping * rate.dot(along.col(i))) /
                             chain.rest_length[i];
      f.col(i) += tension * along.col(i);
      f.col(i + 1) -= tension * along.col(i);
    }
    for (Index i = 0; i + 1 < segments; ++i) {  // EI·θ/ℓ̄
      const Eigen::Vector2d a = along.col(i), b = along.col(i + 1);
      const double angle = std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b));
      const double moment = cloth.hinge_stiffness * angle / chain.hinge_length[i];
      const Eigen::Vector2d left = moment / length[i] * Eigen::Vector2d(-a.y(), a.x());
      const Eigen::Vector2d right = moment / length[i + 1] * Eigen::Vector2d(-b.y(), b.x());
      f.col(i) -= left;
      f.col(i + 1) += left + right;
      f.col(i + 2) -= right;
    }
    v = (1 - h * chain.drag_rate) * v + h / chain.particle_mass * f;
    v.row(1).array() -= h * chain.gravity;
    x += h * v;
  }
  const Points& positions() const override { return x; }
  const Points& velocities() const override { return v; }

  const Chain& chain;
  double h;
  Points x, v;
};

struct Engine : Backend {
  Engine(const Problem& problem, Index steps) : Backend("own", problem, steps) {}
  std::unique_ptr<Simulation> do_start(const Points& x, const Points& v) const override {
    return std::make_unique<Flight>(problem().chain(), time_step(), x, v);
  }
  DragRecurrence do_drag_recurrence() const override {
    const double h = time_step(), r = 1 - h * cloth().drag_rate;
    return {.h = h, .r1 = r, .q1 = h, .r = r, .q = h};
  }
};

/// Steps as wished, or 1000, and as many as an explicit spring needs: ω·h < 1/2.
inline std::unique_ptr<Backend> make_backend(const Problem& problem) {
  const Chain& chain = problem.chain();
  const double shortest = chain.rest_length.minCoeff(), t0 = problem.arrival_time;
  const double along = 4 * chain.material.stretch_stiffness / shortest;
  const double across = 16 * chain.material.hinge_stiffness / std::pow(shortest, 3);
  const double h = std::min(problem.time_step.value_or(t0 / 1000),
                            0.5 / std::sqrt((along + across) / chain.particle_mass));
  return std::make_unique<Engine>(problem, static_cast<Index>(std::ceil(t0 / h)));
}

}  // namespace nuno::own
