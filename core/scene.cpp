#include <nuno/scene.h>

#include <nuno/mesh_fault.h>

#include <fmt/format.h>

#include <cmath>
#include <utility>

namespace nuno {
namespace {

[[noreturn]] void refuse(const std::string& source, std::string_view field,
                         const std::string& what) {
  throw InputError(fmt::format("{}: {}: {}", source, field, what));
}

void require_positive(const std::string& source, std::string_view field, double value) {
  if (!(value > 0)) refuse(source, field, fmt::format("{} is not > 0", value));
  if (!(value >= smallest_scene_number && value <= largest_scene_number)) {
    refuse(source, field,
           fmt::format("{} is not within {} … {}", value, smallest_scene_number,
                       largest_scene_number));
  }
}

void require_not_negative(const std::string& source, std::string_view field, double value) {
  if (!(value >= 0)) refuse(source, field, fmt::format("{} is not >= 0", value));
  if (!(value <= largest_scene_number)) {
    refuse(source, field, fmt::format("{} is not <= {}", value, largest_scene_number));
  }
}

void require_polyline(const std::string& source, std::string_view field, const Points& line) {
  if (line.cols() < 2) {
    refuse(source, field,
           fmt::format("{} point(s) are not at least 2 distinct points", line.cols()));
  }
  for (Index i = 0; i < line.cols(); ++i) {
    for (Index row = 0; row < line.rows(); ++row) {
      const double value = line(row, i);
      if (!(std::abs(value) <= largest_scene_number)) {
        refuse(source, fmt::format("{}/{}/{}", field, i, row),
               fmt::format("{} is not within ±{}", value, largest_scene_number));
      }
    }
  }
  const double length = segment_lengths(line).sum();
  if (!(length > 0)) {
    refuse(source, field, "all points are the same, not at least 2 distinct points");
  }
  if (!(length >= smallest_relative_length * line.cwiseAbs().maxCoeff() &&
        length >= smallest_scene_number)) {
    refuse(source, field,
           fmt::format("length {} is not >= {} and {} of its distance from the origin", length,
                       smallest_scene_number, smallest_relative_length));
  }
}

/// Refuses a fault of the mesh that `field` holds, /initial or /target.
void refuse_fault(const std::string& source, std::string_view field,
                  const std::optional<MeshFault>& fault) {
  if (!fault) return;
  switch (fault->at) {
    case MeshFault::At::mesh:
      refuse(source, field, fault->what);
    case MeshFault::At::face:
      refuse(source, fmt::format("{}/faces/{}", field, fault->number), fault->what);
    case MeshFault::At::vertex:
      refuse(source, fmt::format("{}/vertices/{}", field, fault->number), fault->what);
  }
}

/// e^z must stay a number with digits to spare.
void require_drag(const std::string& source, double air_drag, double rate, double arrival_time) {
  const double drag_turns = rate * arrival_time;
  if (!(drag_turns <= 700)) {
    refuse(source, "/cloth/air_drag",
           fmt::format("{} stops the cloth: air_drag/mass·arrival_time = {} is not <= 700",
                       air_drag, drag_turns));
  }
}

void require_timing(const Scene& scene, const std::string& source) {
  require_positive(source, "/arrival_time", scene.arrival_time);
  require_not_negative(source, "/gravity", scene.gravity);
}

void require_choices(const Scene& scene, const std::string& source) {
  if (scene.time_step) require_positive(source, "/time_step", *scene.time_step);
  require_positive(source, "/frames_per_second", scene.frames_per_second);
  require_not_negative(source, "/damping_ratio", scene.damping_ratio);
}

}  // namespace

void validate(const ChainScene& scene, const std::string& source) {
  if (scene.particles < smallest_particles || scene.particles > largest_particles) {
    refuse(source, "/particles",
           fmt::format("{} is not within {} … {}", scene.particles, smallest_particles,
                       largest_particles));
  }
  require_timing(scene, source);
  require_polyline(source, "/initial", scene.initial);
  require_polyline(source, "/target", scene.target);
  require_positive(source, "/cloth/mass", scene.cloth.mass);
  require_not_negative(source, "/cloth/air_drag", scene.cloth.air_drag);
  require_positive(source, "/cloth/stretch_stiffness", scene.cloth.stretch_stiffness);
  require_not_negative(source, "/cloth/stretch_damping", scene.cloth.stretch_damping);
  require_not_negative(source, "/cloth/hinge_stiffness", scene.cloth.hinge_stiffness);
  require_not_negative(source, "/cloth/hinge_damping", scene.cloth.hinge_damping);
  require_choices(scene, source);
  require_drag(source, scene.cloth.air_drag, scene.cloth.air_drag / scene.cloth.mass,
               scene.arrival_time);
}

void validate(const SheetScene& scene, const std::string& source) {
  for (const auto& [field, points] :
       {std::pair{"/initial", &scene.initial}, std::pair{"/target", &scene.target}}) {
    if (points->rows() != 3) {
      refuse(source, field, fmt::format("vertices of {} numbers have not 3", points->rows()));
    }
  }
  if (scene.target.cols() != scene.initial.cols()) {
    refuse(source, "/target",
           fmt::format("{} vertices are not the {} of /initial", scene.target.cols(),
                       scene.initial.cols()));
  }
  require_timing(scene, source);
  refuse_fault(source, "/initial", vertex_fault(scene.initial));
  refuse_fault(source, "/target", vertex_fault(scene.target));
  refuse_fault(source, "/initial", mesh_fault(scene.initial, scene.faces));
  require_positive(source, "/cloth/areal_density", scene.cloth.areal_density);
  require_not_negative(source, "/cloth/air_drag", scene.cloth.air_drag);
  require_positive(source, "/cloth/stretch_stiffness", scene.cloth.stretch_stiffness);
  require_not_negative(source, "/cloth/stretch_damping", scene.cloth.stretch_damping);
  require_not_negative(source, "/cloth/shear_stiffness", scene.cloth.shear_stiffness);
  require_not_negative(source, "/cloth/shear_damping", scene.cloth.shear_damping);
  require_not_negative(source, "/cloth/bending_stiffness", scene.cloth.bending_stiffness);
  require_not_negative(source, "/cloth/bending_damping", scene.cloth.bending_damping);
  require_choices(scene, source);
  require_drag(source, scene.cloth.air_drag, scene.cloth.air_drag / scene.cloth.areal_density,
               scene.arrival_time);
}

}  // namespace nuno
