#pragma once

#include <string_view>

#include "svg_values.h"

namespace nuno {

/// Whether an element of this kind draws a line itself.
bool is_svg_shape(std::string_view kind);

/// What an element draws, in its own units. Lengths in % are of `viewport`.
SvgPath svg_shape(const SvgElement& element, const Viewport& viewport);

}  // namespace nuno
