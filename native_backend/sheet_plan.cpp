#include "sheet_plan.h"

#include <nuno/backend.h>
#include <nuno/sheet_stiffness.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <queue>

namespace nuno::native {
namespace {

double kick_time(double drag_rate, double h) {
  return drag_rate * h > 0 ? -std::expm1(-drag_rate * h) / drag_rate : h;
}

// ---- steps that are stable ------------------------------------------------------------------

/// The largest eigenvalue of M⁻¹·Σ k·g·gᵀ [1/s² of stiffnesses, 1/s of dampings], by power
/// iteration from a rough pattern: within some per cent, from below.
double largest_eigenvalue(const Sheet& sheet, const LinearElements& linear,
                          const std::vector<double>& weights) {
  constexpr int iterations = 60;
  const Index n = sheet.particles();
  Points x(3, n);
  for (Index i = 0; i < x.size(); ++i) {
    const double k = static_cast<double>(i + 1);
    x.data()[i] = std::sin(1.7 * k + 0.61803 * k * k);
  }
  double eigenvalue = 0;
  for (int iteration = 0; iteration < iterations; ++iteration) {
    x.normalize();
    Points y = Points::Zero(3, n);
    for (std::size_t e = 0; e < linear.count(); ++e) {
      const std::size_t first = e * static_cast<std::size_t>(linear.nodes);
      double change = 0;
      for (std::size_t k = first; k < first + static_cast<std::size_t>(linear.nodes); ++k) {
        change += linear.gradient[k].dot(x.col(linear.at[k]).head<3>());
      }
      for (std::size_t k = first; k < first + static_cast<std::size_t>(linear.nodes); ++k) {
        y.col(linear.at[k]) += (weights[e] * change) * linear.gradient[k];
      }
    }
    for (Index i = 0; i < n; ++i) y.col(i) /= sheet.particle_mass * sheet.relative_mass[i];
    eigenvalue = y.norm();
    if (!(eigenvalue > 0)) return 0;
    x = y;
  }
  return eigenvalue;
}

/// A field of the scene, with its value.
struct Asker {
  const char* field = "";
  double value = 0;
};

/// The largest stable step, and what asks for it. With ω the highest frequency and c the
/// highest damping rate, the leapfrog with lagging dashpots is stable where h²ω² + 2hc < 4.
struct StableStep {
  double h = 0;
  Asker asker;
};

StableStep stable_step(const Sheet& sheet, const LinearElements& linear, const Asker& stiffness,
                       const Asker& damping) {
  const double squared = largest_eigenvalue(sheet, linear, linear.stiffness);
  const double rate = largest_eigenvalue(sheet, linear, linear.damping);
  // h = 4/(c + √(c² + 4ω²)), the root of h²ω² + 2hc = 4.
  return {4 / (rate + std::sqrt(rate * rate + 4 * squared)),
          rate * rate > 4 * squared ? damping : stiffness};
}

// ---- the order of the particles -------------------------------------------------------------

/// Breadth first from one end of the sheet (Cuthill and McKee 1969), so that what particles have in
/// common is near each other in memory: entry i is the index of the plan's particle i in the sheet.
std::vector<Index> ordered_particles(const Sheet& sheet) {
  const auto n = static_cast<std::size_t>(sheet.particles());
  std::vector<std::vector<Index>> neighbours(n);
  for (Index e = 0; e < sheet.edges.cols(); ++e) {
    const Index a = sheet.edges(0, e), b = sheet.edges(1, e);
    neighbours[static_cast<std::size_t>(a)].push_back(b);
    neighbours[static_cast<std::size_t>(b)].push_back(a);
  }
  const auto degree = [&](Index i) { return neighbours[static_cast<std::size_t>(i)].size(); };
  for (auto& each : neighbours) std::ranges::stable_sort(each, {}, degree);
  const auto breadth_first = [&](Index from) {
    std::vector<bool> seen(n, false);
    std::vector<Index> order;
    const auto visit = [&](Index i) {
      if (seen[static_cast<std::size_t>(i)]) return;
      seen[static_cast<std::size_t>(i)] = true;
      order.push_back(i);
    };
    visit(from);
    for (std::size_t next = 0, other = 0; order.size() < n || next < order.size();) {
      if (next == order.size()) {  // another part of the sheet
        while (seen[other]) ++other;
        visit(static_cast<Index>(other));
      }
      for (const Index j : neighbours[static_cast<std::size_t>(order[next++])]) visit(j);
    }
    return order;
  };
  // The last one reached is far out; so is what is last from there.
  const Index far = breadth_first(0).back();
  return breadth_first(breadth_first(far).back());
}

void add_springs(const Sheet& sheet, double h, SheetPlan& plan) {
  struct Spring {
    Index near, far;
    double stiffness, rest_length, damping;
  };
  std::vector<Spring> all;
  bool damped = false;
  for (const Springs* springs : {&sheet.stretch, &sheet.shear}) {
    for (Index e = 0; e < springs->count(); ++e) {
      const auto [near, far] =
          std::minmax(plan.plan_index[static_cast<std::size_t>(springs->ends(0, e))],
                      plan.plan_index[static_cast<std::size_t>(springs->ends(1, e))]);
      all.push_back(
          {near, far, springs->stiffness[e], springs->rest_length[e], springs->damping[e]});
      damped = damped || springs->damping[e] > 0;
    }
  }
  std::ranges::sort(all, {}, [](const Spring& s) { return std::pair(s.near, s.far); });
  plan.first_spring.assign(static_cast<std::size_t>(plan.particles + 1), 0);
  for (const Spring& each : all) {
    ++plan.first_spring[static_cast<std::size_t>(each.near + 1)];
    plan.far_end.push_back(each.far);
    plan.spring.push_back(each.stiffness + each.damping / h);
    plan.rest_tension.push_back(each.stiffness * each.rest_length);
    if (damped) plan.dashpot.push_back(each.damping / h);
  }
  std::partial_sum(plan.first_spring.begin(), plan.first_spring.end(), plan.first_spring.begin());
}

void add_hinges(const Hinges& hinges, SheetPlan& plan) {
  std::vector<std::pair<Index, Index>> order;  // of the first of its particles, and itself
  for (Index h = 0; h < hinges.count(); ++h) {
    Index first = plan.particles;
    for (const Index corner : hinges.corners.col(h)) {
      first = std::min(first, plan.plan_index[static_cast<std::size_t>(corner)]);
    }
    if (hinges.stiffness[h] > 0 || hinges.damping[h] > 0) order.emplace_back(first, h);
  }
  std::ranges::sort(order);
  const bool damped = hinges.count() > 0 && hinges.damping.maxCoeff() > 0;
  for (const auto& [first, h] : order) {
    for (const Index corner : hinges.corners.col(h)) {
      plan.corners.push_back(plan.plan_index[static_cast<std::size_t>(corner)]);
    }
    plan.hinge_spring.push_back(hinges.stiffness[h]);
    plan.rest_cosine.push_back(std::cos(hinges.rest_angle[h]));
    plan.rest_sine.push_back(std::sin(hinges.rest_angle[h]));
    if (damped) plan.hinge_dashpot.push_back(hinges.damping[h] / plan.time_step);
  }
}

}  // namespace

SheetSteps choose_steps(const Problem& problem) {
  constexpr double spring_safety = 0.6;
  constexpr double hinge_safety = 0.5;
  constexpr double default_steps = 800;

  const Sheet& sheet = problem.sheet();
  const SheetMaterial& cloth = sheet.material;
  const StableStep springs = stable_step(sheet, linear_springs(sheet, sheet.initial),
                                         {"/cloth/stretch_stiffness", cloth.stretch_stiffness},
                                         {"/cloth/stretch_damping", cloth.stretch_damping});
  const StableStep hinges = stable_step(sheet, linear_hinges(sheet, sheet.initial),
                                        {"/cloth/bending_stiffness", cloth.bending_stiffness},
                                        {"/cloth/bending_damping", cloth.bending_damping});
  const double usual = std::min(problem.arrival_time / default_steps, hinge_safety * hinges.h);
  double h = problem.time_step.value_or(problem.arrival_time / default_steps);
  Asker asker = problem.time_step ? Asker{"/time_step", *problem.time_step}
                                  : Asker{"/arrival_time", problem.arrival_time};
  if (!(h > 0)) throw InputError(fmt::format("/time_step: {} is not > 0", h));
  if (!(h <= hinge_safety * hinges.h)) {
    h = hinge_safety * hinges.h;
    asker = hinges.asker;
  }
  // A smaller step than usual asks for more precision of all forces, so that the springs have as
  // many substeps in it as in the usual.
  const double substeps = std::ceil(std::max(h, usual) / (spring_safety * springs.h));
  if (substeps > 1) asker = springs.asker;
  const double steps = std::ceil(problem.arrival_time / h * (1 - 1e-12));
  if (!(steps * substeps <= most_steps)) {
    throw InputError(fmt::format("{}: {} takes {:.3g} steps on native, which is not <= {:.0f}",
                                 asker.field, asker.value, steps * substeps, most_steps));
  }
  return {std::max<Index>(static_cast<Index>(steps), 1), static_cast<Index>(substeps)};
}

SheetPlan make_sheet_plan(const Problem& problem, const SheetSteps& steps) {
  const Sheet& sheet = problem.sheet();
  SheetPlan plan;
  plan.particles = sheet.particles();
  plan.steps = steps.steps;
  plan.substeps = steps.substeps;
  plan.time_step = problem.arrival_time / static_cast<double>(steps.steps);
  plan.substep = plan.time_step / static_cast<double>(steps.substeps);
  plan.particle_mass = sheet.particle_mass;
  plan.damping_ratio = problem.damping_ratio;
  plan.relative_mass.assign(sheet.relative_mass.begin(), sheet.relative_mass.end());
  plan.keep = std::exp(-sheet.drag_rate * plan.substep);
  plan.kick_time = kick_time(sheet.drag_rate, plan.substep);
  plan.first_keep = std::exp(-sheet.drag_rate * plan.substep / 2);
  plan.first_share = kick_time(sheet.drag_rate, plan.substep / 2) / plan.kick_time;

  plan.user_index = ordered_particles(sheet);
  plan.plan_index.resize(plan.user_index.size());
  for (std::size_t i = 0; i < plan.user_index.size(); ++i) {
    const Index user = plan.user_index[i];
    plan.plan_index[static_cast<std::size_t>(user)] = static_cast<Index>(i);
    const double mass = sheet.particle_mass * sheet.relative_mass[user];
    plan.weight.push_back(mass * sheet.gravity);
    plan.move.push_back(plan.substep * plan.kick_time / mass);
    plan.speed.push_back(plan.kick_time / (plan.keep * mass));
  }
  add_springs(sheet, plan.substep, plan);
  add_hinges(sheet.hinges, plan);
  return plan;
}

}  // namespace nuno::native
