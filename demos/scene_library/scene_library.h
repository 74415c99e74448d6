#pragma once

#include <nuno/scene.h>

#include <cstdint>
#include <string_view>
#include <vector>

/// Scenes that tests, benchmarks and demos share; all are made from numbers, none is drawn.
namespace nuno::scene_library {

/// A curve of the given length [m] whose direction is direction(s), s from 0 to 1, about `center`.
Points curve_from_direction(double (*direction)(double s), double length, const Vector& center);

/// A straight 1 m cloth of 32 particles to an S of the same length, 1 s, 3 m away.
ChainScene straight_to_s();

/// The n-th scene of a seeded family: initial and target of smooth random curvature (turning up to
/// ±1.5π), t₀ 0.4 … 2 s, hinge stiffness over three decades, stretch stiffness 200, 2000 or
/// 20 000 N, both launches; every eighth has a sharp target instead (fold, letter Z, hairpin). The
/// same n gives the same scene everywhere.
ChainScene family_member(std::uint64_t n);

/// The first `count` of them.
std::vector<ChainScene> family(std::uint64_t count);

/// A single-stroke figure about the origin, 1 m long [2 × any]: see figure_names.
Points figure(std::string_view name);

/// "C", "J", "L", "M", "N", "O", "S", "U", "V", "W", "Z", "2", "3", "6", "arch", "hook", "line",
/// "spiral", "wave", "infinity".
const std::vector<std::string_view>& figure_names();

/// Twenty throws of a 1 m cloth of 32 particles onto these figures, from a line and from one
/// another, in 0.6 to 1.2 s.
std::vector<ChainScene> figure_throws();

}  // namespace nuno::scene_library
