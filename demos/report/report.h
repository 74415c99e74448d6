#pragma once

#include <string>
#include <vector>

#include "../comparison.h"
#include "../engines.h"
#include "../figures/flight_figure.h"

namespace nuno {

/// Both engines' flights at one choice of gains.
struct ReportChoice {
  std::string label;
  std::vector<figures::Flight> flights;  ///< of the first engine and the second
};

/// What the report shows of one scene.
struct ReportScene {
  Comparison comparison;
  Index particles = 0;
  double arrival_time = 0;
  std::vector<Evaluation> descent;  ///< of the first engine
  std::vector<ReportChoice> choices;
};

/// Flies what the page plays: each engine at its best gain, both at the same gains.
ReportScene make_report_scene(const Comparison& comparison, const Backend& first,
                              const Backend& second);

/// E(α) of a comparison; its width in pixels decides how much is written on it.
std::string gain_figure(const ReportScene& scene, double width, bool for_page);

/// The whole page, which needs nothing else.
std::string report_page(const std::vector<ReportScene>& scenes);

}  // namespace nuno
