#pragma once

#include <nuno/sheet.h>

namespace nuno {

/// The lowest modes of a sheet, but for the constant one: how a free membrane of its shape and
/// masses swings, from its longest wave on. K·φⱼ = λⱼ·M·φⱼ, where K is the Laplacian of the mesh at
/// rest by linear finite elements (the cotangent Laplacian; a quad counts as the mean of its
/// triangulations, so that no diagonal is preferred) and M the relative masses.
struct SheetModes {
  Points shapes;  ///< φⱼ(i) [modes × N], orthonormal: φⱼ·M·φₖ is 1 where j = k, else 0
  Vector eigenvalues;  ///< λⱼ [modes], ascending [1]
};

/// The first `count` < N of them, by inverse iteration of a block of vectors (Bathe and Wilson
/// 1972) until K·φ is λ·M·φ to rounding. The same sheet gives the same bits. Modes of one
/// eigenvalue are any that span its space.
SheetModes sheet_modes(const Sheet& sheet, Index count);

}  // namespace nuno
