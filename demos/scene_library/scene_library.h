#pragma once

#include <nuno/scene.h>

#include <cstdint>
#include <vector>

/// Scenes that tests, benchmarks and demos share; all are made from numbers, none is drawn.
namespace nuno::scene_library {

/// A curve of the given length [m] whose direction is direction(s), s from 0 to 1, about `center`.
Points curve_from_direction(double (*direction)(double s), double length, const Vector& center);

/// A straight 1 m cloth of 32 particles to an S of the same length, 1 s, 3 m away.
Scene straight_to_s();

/// The n-th scene of a seeded family: initial and target of smooth random curvature (turning up to
/// ±1.5π), t₀ 0.4 … 2 s, hinge stiffness over three decades, both launches; every eighth has a
/// sharp target instead (fold, letter Z, hairpin). The same n gives the same scene everywhere.
Scene family_member(std::uint64_t n);

/// The first `count` of them.
std::vector<Scene> family(std::uint64_t count);

}  // namespace nuno::scene_library
