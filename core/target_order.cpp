#include <nuno/target_order.h>

#include <nuno/conditioning.h>
#include <nuno/optimize.h>

#include <fmt/format.h>

#include <algorithm>

namespace nuno {
namespace {

std::optional<TargetOrders::Arrival> best_arrival(const ChainScene& scene,
                                                  const MakeBackend& make) {
  const auto backend = make(make_problem(scene));
  const Rollout flight = rollout(*backend, global_search(objective(*backend)).gain);
  if (diverged(flight)) return std::nullopt;
  return TargetOrders::Arrival{flight.error.mean / backend->cloth().size, flight.control_effort};
}

}  // namespace

ChainScene reversed(ChainScene scene) {
  scene.target_order =
      scene.target_order == TargetOrder::reversed ? TargetOrder::as_drawn : TargetOrder::reversed;
  return scene;
}

std::optional<TargetOrders> compare_target_orders(const ChainScene& scene,
                                                  const MakeBackend& make) {
  ChainScene coarse = scene;
  coarse.particles = std::min<Index>(scene.particles, 32);
  coarse.time_step.reset();
  try {
    const Problem problem = make_problem(coarse);
    const Points initial = shape_of(problem.cloth().initial), target = shape_of(problem.target);
    if ((target.rowwise().reverse() - initial).norm() >= (target - initial).norm()) {
      return std::nullopt;
    }
    const auto as_asked = best_arrival(coarse, make);
    const auto the_other_way = best_arrival(reversed(coarse), make);
    if (!as_asked || !the_other_way) return std::nullopt;
    return TargetOrders{*as_asked, *the_other_way};
  } catch (const InputError&) {  // a drawing of many turns may not bear so few particles
    return std::nullopt;
  }
}

std::string advice(const TargetOrders& orders) {
  const auto& [now, then] = orders;
  const bool is_nearer = then.error < 0.5 * now.error;
  const bool is_cheaper = then.effort < 0.5 * now.effort && then.error <= now.error;
  if (!is_nearer && !is_cheaper) return {};
  return fmt::format(
      "The target runs the other way round from the cloth. Reversed, the best gain comes within "
      "{:.2g} % of the length at {:.2g} of control effort, not {:.2g} % at {:.2g}.",
      100 * then.error, then.effort, 100 * now.error, now.effort);
}

}  // namespace nuno
