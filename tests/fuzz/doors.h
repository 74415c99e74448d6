#pragma once

#include <chrono>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

/// Where a user's bytes come in.
namespace nuno::fuzz {

enum class Door { scene, sheet_scene, mesh, result, page_request };
inline constexpr std::size_t doors = 5;

/// What is right at a door, to start from.
std::vector<std::string> seeds(Door door);

/// Brings `input` in as a user would, and flies, draws or answers what is let in, if that is little
/// work. Aborts with a word where it finds a NaN, no UTF-8, or an answer that is none; gives
/// whether it was let in. What a page asks for ends after `patience`, as if its client left.
bool enter(Door door, const std::string& input,
           std::chrono::milliseconds patience = std::chrono::milliseconds(20));

}  // namespace nuno::fuzz
