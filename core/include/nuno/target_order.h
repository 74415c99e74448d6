#pragma once

#include <nuno/refine.h>
#include <nuno/scene.h>

#include <optional>
#include <string>

namespace nuno {

/// A chain's scene at its best gain, with its target from either end.
struct TargetOrders {
  struct Arrival {
    double error = 0;   ///< mean distance over L
    double effort = 0;  ///< control effort, see Rollout
  };
  Arrival as_asked, the_other_way;
};

/// The same scene with its target from the other end.
ChainScene reversed(ChainScene scene);

/// Both flights, of at most 32 particles, where the cloth seems to lie the other way round: there,
/// its particles would be nearer to the target's, both about their centroids. Else, and where
/// either way cannot be flown, nothing.
std::optional<TargetOrders> compare_target_orders(const ChainScene& scene, const MakeBackend& make);

/// What reversing would give, in a sentence for people; empty where it would not halve the error,
/// or the effort at no more error.
std::string advice(const TargetOrders& orders);

}  // namespace nuno
