#pragma once

#include <nuno/scene.h>

#include <span>
#include <string>
#include <string_view>

namespace nuno {

/// A cloth known by name, as measured; see docs/materials.md for the sources.
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
