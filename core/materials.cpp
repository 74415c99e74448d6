#include <nuno/materials.h>

#include <algorithm>
#include <array>

namespace nuno {
namespace {

// What Kawabata's instruments (KES-F) give, in their units, and as a sheet takes it.
constexpr double gram_force = 9.80665e-3;                  // N
constexpr double per_width = gram_force / 1e-2;            // gf/cm [N/m]
constexpr double bending_unit = gram_force * 1e-4 / 1e-2;  // gf·cm²/cm [N·m]
constexpr double degree = 3.14159265358979323846 / 180;

/// Of a measured fabric, warp and weft taken together:
///  - areal density [kg/m²];
///  - extension [%] under 500 gf/cm;
///  - shear stiffness G [gf/(cm·degree)];
///  - bending rigidity B [gf·cm²/cm].
constexpr SheetMaterial measured(double density, double extension, double shear, double bending) {
  SheetMaterial cloth;
  cloth.areal_density = density;
  cloth.stretch_stiffness = 500 * per_width / (extension / 100);
  // Both diagonals of a square resist shear with half of shear_stiffness each, and make half of it.
  cloth.shear_stiffness = 2 * shear * per_width / degree;
  // A square grid bends with three times bending_stiffness, see sheet.h.
  cloth.bending_stiffness = bending * bending_unit / 3;
  return cloth;
}

// Denim's last three are a published table's means; the others are typical orders of magnitude,
// traced to no table. docs/materials.md says which is which.
constexpr std::array materials = {
    NamedMaterial{"cotton", measured(0.150, 5.0, 1.0, 0.06)},
    NamedMaterial{"silk", measured(0.060, 3.5, 0.3, 0.03)},
    NamedMaterial{"denim", measured(0.400, 5.2, 1.96, 0.174)},
    NamedMaterial{"wool", measured(0.210, 6.5, 0.65, 0.10)},
};

}  // namespace

std::span<const NamedMaterial> named_materials() { return materials; }

const NamedMaterial* find_material(std::string_view name) {
  const auto* const found = std::ranges::find(materials, name, &NamedMaterial::name);
  return found == materials.end() ? nullptr : found;
}

std::string material_names() {
  std::string names;
  for (const NamedMaterial& each : materials) {
    names += (names.empty() ? "" : ", ") + std::string(each.name);
  }
  return names;
}

}  // namespace nuno
