#pragma once

#include <nuno/rollout.h>

#include <functional>
#include <string>

namespace nuno {

/// Makes an engine ready for a problem.
using MakeBackend = std::function<std::unique_ptr<Backend>(const Problem&)>;

struct RefineOptions {
  double tolerance = 1e-9;   ///< mean distance at arrival that is near enough, over L, > 0
  double least_gain = 0.05;  ///< a round that takes less of the error away is the last, 0 … 1
  Index rounds = 16;         ///< ≥ 1
};

/// How near aiming off brought the cloth.
struct RefineSummary {
  bool converged = false;   ///< within the tolerance; if not, the target is out of reach
  Points aim_offset;        ///< δ, to be set as Problem::aim_offset [2 × N], m
  Rollout flight;           ///< with it
  double error_before = 0;  ///< mean distance without it, or with the problem's own [m]
  Index rollouts = 0;       ///< flown
  Index tangents = 0;       ///< taken
  double seconds = 0;       ///< wall clock
  std::string reason;       ///< why it stopped, for people
};

/// Aims off, as an archer does in the wind: lets the reference motion, and the launch along it, end
/// beside the target by an offset δ, so that the cloth itself ends on it. Material and control law
/// stay as they are.
///
/// Levenberg–Marquardt on the 2N coordinates at arrival, min |x(t₀; δ) − target|² + λ²·|δ|², so
/// among offsets that arrive it tends to the least. `make` flies; `model`, which may be another
/// engine, gives the tangent ∂x(t₀)/∂δ (exact for the native chain): an answer of the chain can be
/// corrected on an engine that knows no derivative. Starts from the problem's aim offset.
RefineSummary refine(const Problem& problem, const Gains& gains, const MakeBackend& make,
                     const MakeBackend& model, const RefineOptions& options = {});

}  // namespace nuno
