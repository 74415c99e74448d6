#pragma once

#include <nuno/rollout.h>

#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

namespace nuno {

/// Makes an engine ready for a problem.
using MakeBackend = std::function<std::unique_ptr<Backend>(const Problem&)>;

struct RefineOptions {
  double tolerance = 1e-9;  ///< mean distance at arrival that is near enough, over L, > 0
  /// Control effort that must not be exceeded (see Rollout); then the error is the least for it. A
  /// flight that takes more although it has been lowered is given with its reason.
  double effort_limit = std::numeric_limits<double>::infinity();
  Index rounds = 60;  ///< flights at most, ≥ 1
};

/// How near trajectory refinement brought the cloth.
struct RefineSummary {
  bool converged = false;                    ///< within the tolerance
  std::vector<Points> reference_correction;  ///< δ, to be set as Problem::reference_correction
  Rollout flight;                            ///< with it
  double error_before = 0;  ///< mean distance without it, or with the problem's own [m]
  Index rollouts = 0;       ///< flown
  Index jacobians = 0;      ///< taken
  double seconds = 0;       ///< wall clock
  std::string reason;       ///< why it stopped, for people
};

/// The gain at which to refine [N/m]: enough for the cloth to follow its reference, on any engine,
/// and no more, since what the cloth follows by itself takes no force at any gain.
double tracking_gain(const Backend& backend);

/// Trajectory refinement: moves the reference motion, and the launch along it, so
/// that the cloth arrives on the target, and on a way that it goes nearly by itself: of all
/// reference corrections δ (see ReferenceMotion) that arrive, those of least control effort.
/// Material and control law stay as they are.
///
/// Gauss–Newton on effort² + weight²·error² while the weight grows, from a flight in which effort
/// counts to one that arrives; where it stops on the way, at the tolerance or at the effort limit,
/// stands a Pareto optimum of both. Less than 1e-3·L from a target within reach, once the
/// jacobian no longer tells what effort could be spared, the rest of the error alone is removed,
/// with the least change to forces and offset. A target whose segments are not as long as the
/// cloth's is out of reach: it ends where coming nearer would cost more than it is worth. `make`
/// flies; `model`, which may be another engine, gives the jacobians (exact for the native chain),
/// each used as long as it foretells what happens: an answer of the chain is corrected on an engine
/// that knows no derivative. Starts from the problem's reference correction.
///
/// A sheet takes no Jacobian, nor `model`: a quasi-Newton method on the residual whose first
/// estimate is the sheet's own stiffness about its target, see sheet_refinement.cpp. It arrives
/// within 1e-6·L, or the tolerance if that is more, in a dozen or two of flights; the last of them
/// that came nearer is the answer. It does not lower the effort of the flight that it starts from,
/// and under an effort limit comes as near as that lets it.
RefineSummary refine(const Problem& problem, double gain, const MakeBackend& make,
                     const MakeBackend& model, const RefineOptions& options = {});

/// Flies what `refine` found with `model` alone on another engine, `make`, and takes away what is
/// left of its residual there with a few flights more. Within 1e-5·L, or the tolerance if that is
/// more, it has arrived: an engine may compute in single precision. Under an effort limit it is
/// flown and no more.
RefineSummary transfer(const Problem& problem, const RefineSummary& answer, const MakeBackend& make,
                       const MakeBackend& model, const RefineOptions& options = {});

}  // namespace nuno
