#pragma once

#include <nuno/problem.h>

#include <vector>

namespace nuno::bench {

/// The scene whose optimum is sought: a straight cloth to an S, by this many particles.
ChainScene straight_to_s(Index particles);

/// The flight that every engine can make, those too that take no launch velocity: an S-curve let
/// go at rest; it falls and unbends, without air. Its target is itself, where it has fallen.
Problem release(Index particles);

/// A flat square sheet of so many columns and rows of vertices that is thrown into an S, damped
/// `morph`; every edge of the target has its length to rounding.
Problem thrown_sheet(Index columns, double stretch_stiffness = 500);

/// That S let go at rest, without air. Its target is itself, where it has fallen.
Problem released_sheet(Index columns);

/// `count` gains from 0 over everything between hardly felt and stiff, `scale` = m/t₀².
std::vector<double> spread_gains(double scale, Index count);

}  // namespace nuno::bench
