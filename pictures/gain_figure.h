#pragma once

#include <nuno/optimize.h>

#include <string>
#include <vector>

#include "pictures/drawing.h"

namespace nuno::figures {

/// E(α) of one engine; errors in metres, gains in N/m.
struct GainCurve {
  std::string backend;
  double launch_only_error = 0;          ///< E(0)
  std::vector<Evaluation> curve = {};    ///< ascending gains > 0
  std::vector<Evaluation> descent = {};  ///< the path of steepest descent, if there is one
  Evaluation best = {};
};

/// The curve's local minima, each at the vertex of the parabola through its three lowest points.
std::vector<Evaluation> local_minima(const std::vector<Evaluation>& curve);

struct GainFigure {
  std::string title;
  std::string subtitle;
  double width = 800, height = 430;
  bool cursor = false;  ///< leaves a marker at the best gain that a script moves
};

/// Figure 5: error at arrival against the gain, for one cloth of length L and every engine given.
Drawing draw_gain_curves(const std::vector<GainCurve>& curves, double cloth_length,
                         const GainFigure& options);

}  // namespace nuno::figures
