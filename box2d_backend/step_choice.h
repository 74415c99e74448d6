#pragma once

#include <nuno/problem.h>

#include <optional>

namespace nuno::box2d {

/// The steps of a flight: those of a wish [s] or of the default, more where the cloth is not stable
/// at them. Throws InputError for a wish that is none and for more than most_steps.
Index count_steps(const Problem& problem, std::optional<double> time_step);

}  // namespace nuno::box2d
