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

std::string crossing_words(const FlightCrossings& crossings, double size) {
  // Two digits; a fall below the ground is many times the cloth.
  const auto percent = [&](double depth) {
    const double share = 100 * depth / size;
    return share < 99.5 ? fmt::format("{:.2g}", share) : fmt::format("{:.0f}", share);
  };
  std::string words = fmt::format("itself in no frame of {}", crossings.frames);
  if (crossings.crossed_frames > 0) {
    words = fmt::format("itself in {} of {} frames, first at {:.3g} s; {} % of L deep at {:.3g} s",
                        crossings.crossed_frames, crossings.frames, crossings.first_time,
                        percent(crossings.depth), crossings.deepest_time);
  }
  if (crossings.grounded_frames > 0) {
    words += fmt::format("; the ground in {} frames, first at {:.3g} s, {} % of L deep",
                         crossings.grounded_frames, crossings.ground_time,
                         percent(crossings.ground_depth));
  }
  return words;
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
  if (backend.problem().is_sheet() && !rollout.frame_times.empty()) {
    const FlightCrossings crossings =
        flight_crossings(backend.problem(), rollout.frame_times, rollout.frame_positions);
    fmt::print(file, "  {:<17} {}\n", "passes through", crossing_words(crossings, cloth.size));
  }
  const std::string warning = caution(rollout, sensitivity, backend.time_step());
  if (!warning.empty()) fmt::print(file, "  {}\n", warning);
}

}  // namespace nuno
