#pragma once

#include <nuno/scene.h>

#include <span>
#include <string>
#include <string_view>

namespace nuno {

/// A cloth known by name; docs/materials.md says which of its values were measured, and by whom.
struct NamedMaterial {
  std::string_view name;
  SheetMaterial cloth;
};

std::span<const NamedMaterial> named_materials();

/// Null where there is none of this name.
const NamedMaterial* find_material(std::string_view name);

/// Their names with commas between, for messages.
std::string material_names();

}  // namespace nuno
