#pragma once

#include <nuno/points.h>

#include <algorithm>
#include <array>
#include <span>
#include <vector>

namespace nuno {

struct Problem;

/// The gains α of shape control [N/m], one for every group of the shape's modes.
///
/// Mode j = 1 … N − 1 of a chain of N particles is the cosine φⱼ(i) = √(2/N)·cos(πj·(i + ½)/N), i
/// from 0: how a free chain of equal masses and springs swings, from its slowest wave to its
/// fastest. Those of a sheet are the same of its mesh, see sheet_modes.h. Weighted with the masses,
/// modes sum to zero over the particles, so that a gain of one's own for each still corrects shape
/// only. The groups of a chain are modes 1–2, 3–5 and 6–11, those of a sheet end at
/// last_modes_of_sheet_group; the last group is all that are left. One group, the paper's law, is
/// every mode alike.
struct Gains {
  std::vector<double>
      low;          ///< of the groups of low modes, from low to high; fewer than most_groups
  double rest = 0;  ///< of the last group

  /// One gain for all modes.
  Gains(double gain) : rest(gain) {}

  /// A gain for every group, the last group's last; 1 … most_groups of them.
  static Gains of_groups(std::span<const double> groups);

  std::vector<double> groups() const;
  Index count() const { return static_cast<Index>(low.size()) + 1; }
  double largest() const;

  /// The same law in `count` groups, not fewer than now: the last gain is repeated.
  Gains split(Index count) const;
};

/// The last mode of each group of a chain but the last.
inline constexpr std::array<Index, 3> last_mode_of_group = {2, 5, 11};
inline constexpr Index most_groups = static_cast<Index>(last_mode_of_group.size()) + 1;

/// The first and the last mode that may be the last of each group of a sheet. Modes that go
/// together, as the two of a square that are one another turned, are any two of a plane, and a
/// group that had only one of them would pull by how the vertices are numbered. So it ends between
/// first and last where the eigenvalue grows by the largest factor.
struct ModeRange {
  Index first, last;
};
inline constexpr std::array<ModeRange, 3> last_modes_of_sheet_group = {{{3, 5}, {8, 12}, {19, 28}}};
inline constexpr Index most_low_modes =
    std::max(last_mode_of_group.back(), last_modes_of_sheet_group.back().last);

/// The fewest particles whose modes fill this many groups of a chain, and of a sheet.
Index fewest_particles(Index groups);
Index fewest_sheet_particles(Index groups);

/// The modes that have a gain other than the last group's, where there are `groups` groups:
/// orthonormal in ⟨a, b⟩ₘ = Σ (mᵢ/m̄)·aᵢ·bᵢ.
struct LowModes {
  Points shapes;             ///< φⱼ(i) [modes × N]
  std::vector<Index> group;  ///< of each mode, from 0

  /// Of a chain.
  LowModes(Index particles, Index groups);
  /// Of whatever the problem throws, which must have the fewest particles.
  LowModes(const Problem& problem, Index groups);
  Index count() const { return shapes.rows(); }
};

}  // namespace nuno
