#include "step_choice.h"

#include <nuno/backend.h>
#include <nuno/launch.h>

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

namespace nuno::bullet {
namespace {

using Eigen::Vector3d;

constexpr double default_steps = 2000;

/// A step that the engine can take, and what asked for it.
struct StepLimit {
  double h = 0;  // [s]
  const char* field = "";
  double value = 0;
};

/// Largest eigenvalues of M⁻¹K and M⁻¹C, from above, by what adds to them.
struct Rates {
  Vector stretch, shear, bending;  // of every particle [1/s²], [1/s]

  explicit Rates(Index particles)
      : stretch(Vector::Zero(particles)), shear(stretch), bending(stretch) {}
};

// An element, spring or hinge, whose length or angle has the gradients gᵢ stores
//     ½·k·(Σ gᵢ·uᵢ)² ≤ ½·Σᵢ k·|gᵢ|·(Σⱼ |gⱼ|)·|uᵢ|²
// (Cauchy and Schwarz), so that no eigenvalue of M⁻¹K is above the largest sum of
// k·|gᵢ|·Σⱼ|gⱼ|/mᵢ at a particle, whichever way its elements point: a sheet may fold as it likes.
// A spring's gradients are unit vectors, a hinge's the inverse heights of its triangles.
void add_springs(const Springs& springs, const Vector& weight, Vector& sums) {
  for (Index s = 0; s < springs.count(); ++s) {
    for (const Index i : {springs.ends(0, s), springs.ends(1, s)}) sums[i] += 2 * weight[s];
  }
}

std::array<double, 4> hinge_gradients(const Points& x, const Eigen::Matrix<Index, 4, 1>& corners) {
  const Vector3d a = x.col(corners[0]);
  const Vector3d edge = x.col(corners[1]) - a;
  const Vector3d to_c = x.col(corners[2]) - a, to_d = x.col(corners[3]) - a;
  const double length = edge.norm();
  const double c = length / edge.cross(to_c).norm(), d = length / edge.cross(to_d).norm();
  const double s = to_c.dot(edge) / (length * length), t = to_d.dot(edge) / (length * length);
  return {std::abs(1 - s) * c + std::abs(1 - t) * d, std::abs(s) * c + std::abs(t) * d, c, d};
}

void add_hinges(const Points& x, const Hinges& hinges, const Vector& weight, Vector& sums) {
  for (Index h = 0; h < hinges.count(); ++h) {
    if (weight[h] == 0) continue;
    const std::array<double, 4> g = hinge_gradients(x, hinges.corners.col(h));
    const double sum = g[0] + g[1] + g[2] + g[3];
    for (Index k = 0; k < 4; ++k) {
      sums[hinges.corners(k, h)] += weight[h] * g[static_cast<std::size_t>(k)] * sum;
    }
  }
}

Rates rates(const Sheet& sheet, Vector Springs::*of_spring, Vector Hinges::*of_hinge) {
  Rates result(sheet.particles());
  add_springs(sheet.stretch, sheet.stretch.*of_spring, result.stretch);
  add_springs(sheet.shear, sheet.shear.*of_spring, result.shear);
  add_hinges(sheet.initial, sheet.hinges, sheet.hinges.*of_hinge, result.bending);
  const Vector masses = sheet.particle_mass * sheet.relative_mass;
  for (Vector* sums : {&result.stretch, &result.shear, &result.bending}) {
    *sums = sums->cwiseQuotient(masses);
  }
  return result;
}

/// h²ω² + 2hγ ≤ limit, where Bullet's step with dashpots half a step behind is stable up to 4.
StepLimit elastic_limit(const Sheet& sheet) {
  constexpr double limit = 1;
  const Rates elastic = rates(sheet, &Springs::stiffness, &Hinges::stiffness);
  const Rates damped = rates(sheet, &Springs::damping, &Hinges::damping);
  const Vector omega2 = elastic.stretch + elastic.shear + elastic.bending;
  const Vector gamma = damped.stretch + damped.shear + damped.bending;
  const Vector h =
      limit / (gamma.array() + (gamma.array().square() + limit * omega2.array()).sqrt());
  Index i = 0;
  const double smallest = h.minCoeff(&i);

  // What to name: the largest part of the sum at that particle, as far as each shortens the step.
  const SheetMaterial& m = sheet.material;
  const double h2 = smallest * smallest, two_h = 2 * smallest;
  const std::array<std::pair<double, StepLimit>, 6> parts = {{
      {h2 * elastic.stretch[i], {smallest, "/cloth/stretch_stiffness", m.stretch_stiffness}},
      {h2 * elastic.shear[i], {smallest, "/cloth/shear_stiffness", m.shear_stiffness}},
      {h2 * elastic.bending[i], {smallest, "/cloth/bending_stiffness", m.bending_stiffness}},
      {two_h * damped.stretch[i], {smallest, "/cloth/stretch_damping", m.stretch_damping}},
      {two_h * damped.shear[i], {smallest, "/cloth/shear_damping", m.shear_damping}},
      {two_h * damped.bending[i], {smallest, "/cloth/bending_damping", m.bending_damping}},
  }};
  return std::ranges::max_element(parts, {}, [](const auto& part) { return part.first; })->second;
}

/// A launch about the mass centre by no more than L/2 per step, half of what Bullet is asked for.
StepLimit flight_limit(const Problem& problem) {
  const Sheet& sheet = problem.sheet();
  const Points launch = ballistic_launch(sheet.initial, problem.target, problem.arrival_time,
                                         sheet.gravity, sheet.drag_rate);
  const double fastest = sheet.shape_of(launch).colwise().norm().maxCoeff();
  return {0.5 * sheet.size / fastest, "/arrival_time", problem.arrival_time};
}

}  // namespace

Index count_steps(const Problem& problem) {
  StepLimit tightest{problem.arrival_time / default_steps, "/arrival_time", problem.arrival_time};
  if (problem.time_step) tightest = {*problem.time_step, "/time_step", *problem.time_step};
  if (!(tightest.h > 0)) {
    throw InputError(fmt::format("/time_step: {} is not > 0", tightest.value));
  }
  for (const StepLimit& limit : {elastic_limit(problem.sheet()), flight_limit(problem)}) {
    if (!(tightest.h <= limit.h)) tightest = limit;
  }
  const double steps = std::ceil(problem.arrival_time / tightest.h * (1 - 1e-12));
  if (!(steps <= most_steps)) {
    throw InputError(fmt::format("{}: {} takes {:.3g} steps on bullet, which is not <= {:.0f}",
                                 tightest.field, tightest.value, steps, most_steps));
  }
  return std::max<Index>(1, static_cast<Index>(steps));
}

}  // namespace nuno::bullet
