#pragma once

#include <string>
#include <vector>

#include <nuno/comparison.h>
#include <nuno/engines.h>
#include "pictures/flight_figure.h"

namespace nuno {

/// Both engines' flights at one choice of gains.
struct ReportChoice {
  std::string label;
  bool is_pareto = false;  ///< a point of the first engine's best pareto, to be picked there
  std::vector<figures::Flight> flights;  ///< of the first engine and the second
  std::vector<double> efforts;           ///< theirs
};

/// What the report shows of one scene.
struct ReportScene {
  Comparison comparison;
  Index particles = 0;
  double arrival_time = 0;
  std::string effort_unit;
  std::vector<Evaluation> descent;  ///< of the first engine
  std::vector<ReportChoice> choices;
};

/// Flies what the page plays: each engine at its best gain, both at the same gains, some of them
/// along the best pareto of error for effort.
ReportScene make_report_scene(const Comparison& comparison, const Backend& first,
                              const Backend& second);

/// E(α) of a comparison; its width in pixels decides how much is written on it.
std::string gain_figure(const ReportScene& scene, double width, bool for_page);

/// Error against effort of a comparison, in the same way; the page's has the choices to pick.
std::string pareto_figure(const ReportScene& scene, double width, bool for_page);

/// The whole page, which needs nothing else.
std::string report_page(const std::vector<ReportScene>& scenes);

}  // namespace nuno
