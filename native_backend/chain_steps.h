#pragma once

#include <nuno/problem.h>

namespace nuno::native {

/// How a chain's flight is cut into steps.
struct ChainSteps {
  Index count = 0;
  bool implicit_hinges = false;  ///< implicit_hinges-inl.h, not chain_step-inl.h
};

/// The steps of the problem's time step or of the default, more where the hinges or the motion ask
/// for them. Throws InputError for a step that is not > 0 and for more than most_steps.
ChainSteps choose_chain_steps(const Problem& problem);

}  // namespace nuno::native
