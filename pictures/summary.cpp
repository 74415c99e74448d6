#include "pictures/summary.h"

#include <fmt/format.h>

#include <nuno/conditioning.h>
#include <nuno/output.h>
#include <nuno/progress.h>

#include <cmath>

namespace nuno {

std::string duration(double seconds) {
  if (seconds < 1e-3) return fmt::format("{:.3g} µs", 1e6 * seconds);
  if (seconds < 1) return fmt::format("{:.3g} ms", 1e3 * seconds);
  if (seconds < 120) return fmt::format("{:.3g} s", seconds);
  const auto whole = static_cast<long long>(seconds);
  return fmt::format("{} min {} s", whole / 60, whole % 60);
}

std::string effort_unit_name(const Cloth& cloth) {
  return cloth.gravity > 0 ? "of a particle's weight" : "of m·L/t0²";
}

void print_summary(std::FILE* file, const std::string& scene, const Backend& backend,
                   const Rollout& rollout, double sensitivity) {
  const Cloth& cloth = backend.cloth();
  const double percent = 100 / cloth.size;
  fmt::print(file, "{}: {} particles on {}, {} steps of {}\n", printable(scene), cloth.particles(),
             backend.name(), backend.steps(), duration(backend.time_step()));
  const std::vector<double> gains = rollout.gains.groups();
  fmt::print(file, "  {:<17} {:.4g} N/m\n", gains.size() > 1 ? "gains α" : "gain α",
             fmt::join(gains, ", "));
  fmt::print(file, "  {:<17} {:.4g} % of the cloth's {}; worst particle {:.4g} %\n", "error",
             percent * rollout.error.mean, backend.problem().is_sheet() ? "size" : "length",
             percent * rollout.error.max);
  fmt::print(file, "  {:<17} {:.3g} m from the target's\n", "centroid", rollout.error.centroid);
  const double scale = backend.problem().target_scale;
  if (std::abs(scale - 1) > 1e-4) {
    fmt::print(file, "  {:<17} scaled by {:.4f}, to the cloth's {}\n", "target", scale,
               backend.problem().is_sheet() ? "area" : "length");
  }
  fmt::print(file, "  {:<17} {:.4g} {}\n", "control effort", rollout.control_effort,
             effort_unit_name(cloth));
  fmt::print(file, "  {:<17} {:.3g} % at most on the way\n", "strain", 100 * rollout.max_strain);
  fmt::print(file, "  {:<17} {:.3g}-fold growth of a small change at the start\n", "sensitivity",
             sensitivity);
  const std::string warning = fragility(sensitivity);
  if (!warning.empty()) fmt::print(file, "  {}\n", warning);
}

}  // namespace nuno
