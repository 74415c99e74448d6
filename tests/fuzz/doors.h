#pragma once

#include <array>
#include <chrono>
#include <string>
#include <string_view>

/// Where a user's bytes come in.
namespace nuno::fuzz {

using Patience = std::chrono::milliseconds;

/// A kind of input, and what a user does with it.
struct Door {
  const char* name;  ///< also of its folder in corpus/
  /// Brings `input` in, and flies, draws or answers what is let in, if that is little work. Aborts
  /// with a word where it finds a NaN, no UTF-8, or an answer that is none; gives whether the input
  /// was let in, or throws InputError. What a page asks for ends after the patience, as if its
  /// client left.
  bool (*enter)(const std::string& input, Patience patience);
};

bool enter_scene(const std::string& input, Patience);
bool enter_sheet_scene(const std::string& input, Patience);
bool enter_obj(const std::string& input, Patience);  ///< a mesh or drawn lines
bool enter_ply(const std::string& input, Patience);
bool enter_gltf(const std::string& input, Patience);  ///< text or binary
bool enter_svg(const std::string& input, Patience);
bool enter_csv(const std::string& input, Patience);
bool enter_result(const std::string& input, Patience);
bool enter_page(const std::string& input, Patience patience);  ///< a whole request of HTTP

inline constexpr std::array<Door, 9> doors = {{{"scene", enter_scene},
                                               {"sheet-scene", enter_sheet_scene},
                                               {"obj", enter_obj},
                                               {"ply", enter_ply},
                                               {"gltf", enter_gltf},
                                               {"svg", enter_svg},
                                               {"csv", enter_csv},
                                               {"result", enter_result},
                                               {"page-request", enter_page}}};

/// A door's `enter`, with false where the input is refused in words.
bool enter(const Door& door, const std::string& input, Patience patience = Patience(20));

/// Aborts with `what` unless `right`; for what a door finds.
void require(bool right, const char* what, std::string_view about);

}  // namespace nuno::fuzz
