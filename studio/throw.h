#pragma once

#include <nuno/optimize.h>
#include <nuno/refine.h>
#include <nuno/rollout.h>

#include <memory>
#include <optional>
#include <vector>

#include <nuno/engines.h>
#include "studio/request.h"

namespace nuno::studio {

/// A finished throw: which engine, which gain, and how it was found.
struct Throw {
  SceneFile file;
  std::unique_ptr<Backend> backend;
  std::optional<OptimizeSummary> found;
  std::vector<Evaluation> between;       ///< more of E(α) where the search took long strides
  std::optional<RefineSummary> refined;  ///< where it was better than the gain alone
  Rollout flight;
  std::optional<double> sensitivity;  ///< of a flight that was judged
};

/// The frames that a flight keeps: the scene's; or those that the request asks for, to be looked
/// at, with the control forces and how it goes on after arrival.
enum class KeptFrames { of_scene, of_request };

/// The throw at the gain `alpha`, or at the best one where there is none: as `nuno simulate` and
/// `nuno optimize` do it, with their functions and options. It is judged as theirs where the frames
/// are the scene's or the request asks for it. Throws InputError and Stopped.
Throw throw_cloth(const Request& request, std::optional<double> alpha, KeptFrames frames);

}  // namespace nuno::studio
