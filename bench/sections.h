#pragma once

#include <string>

#include "report.h"

namespace nuno::bench {

struct Options {
  bool quick = false;  ///< 80 s for everything instead of minutes
  std::string output;  ///< directory for bench.json and bench.csv; empty: neither
  std::string scenes;  ///< directory of scene files
};

// The sections of the report. Each checks its answers first and then measures.

/// ns per particle-step of the native chain, Box2D's chain and the peers.
void throughput(Report& report, const Options& options);
/// E and dE/dα together over E alone.
void gradient(Report& report, const Options& options);
/// Two cores over one.
void threads(Report& report, const Options& options);
/// Time to the best gain, against the paper's procedure; its growth with the particles.
void optimum(Report& report, const Options& options);
/// Is the gain that is found quickly really the best one?
void minima(Report& report, const Options& options);
/// How exact E(α) is at which cost.
void work_precision(Report& report, const Options& options);
/// ns per particle-step of sheets, on native, on Bullet and of the peers' own cloth.
void sheet_throughput(Report& report, const Options& options);
/// Time to a sheet's best gain and to its refined answer; growth with particles and stiffness.
void sheet_optimum(Report& report, const Options& options);
/// 100 000 particles, 1000 steps: time and memory.
void long_rollout(Report& report, const Options& options);

}  // namespace nuno::bench
