// The tables of docs/two-engines.md that `nuno compare` does not print: what steps, iterations and
// hinge forms do to the gap between the engines on the seeded family. Takes minutes; no test.

#include <nuno/box2d.h>
#include <nuno/native.h>
#include <nuno/optimize.h>
#include <nuno/rollout.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <map>
#include <string>

#include "scene_library.h"

namespace nuno {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double no_answer = -1;  // the spring pair at a fold beyond its range

struct Column {
  std::vector<double> gaps;
  double seconds = 0;
};

/// Median, 95th percentile and worst, as one row of a Markdown table.
void print_row(const std::string& name, const Column& column) {
  std::vector<double> gaps = column.gaps;
  std::erase(gaps, no_answer);
  std::ranges::sort(gaps);
  if (gaps.empty()) return;
  const auto at = [&](double share) {
    return gaps[static_cast<std::size_t>(
        std::lround(share * static_cast<double>(gaps.size() - 1)))];
  };
  std::printf("| %s | %zu | %.1e | %.1e | %.1e | %.0f ms |\n", name.c_str(), gaps.size(), at(0.5),
              at(0.95), gaps.back(), 1e3 * column.seconds / static_cast<double>(gaps.size()));
}

struct Study {
  std::map<std::string, Column> columns;

  void add(const std::string& name, double gap, double seconds) {
    columns[name].gaps.push_back(gap);
    columns[name].seconds += seconds;
  }

  void visit(const ChainScene& scene) {
    const Problem problem = make_problem(scene);
    const double t0 = problem.arrival_time;
    const auto backend = native::make_backend(problem);
    const double gain = global_search(objective(*backend)).gain;
    const Rollout usual = rollout(*backend, gain);
    if (usual.max_strain > 0.005 || sensitivity(*backend, usual) > 10) return;

    const auto gap = [&](const Points& a, const Points& b) {
      return a.allFinite() ? shape_difference(a, b).mean / problem.chain().size : no_answer;
    };
    const double h = backend->time_step();
    const Points fine = rollout(*native::make_backend(with_time_step(problem, h / 32)), gain).final;
    for (const int parts : {1, 2, 4}) {
      const auto start = Clock::now();
      const Points coarse =
          rollout(*native::make_backend(with_time_step(problem, h / parts)), gain).final;
      const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
      const Points half =
          rollout(*native::make_backend(with_time_step(problem, h / (2 * parts))), gain).final;
      add("1 native h/" + std::to_string(parts) + " against half of it", gap(coarse, half),
          seconds);
    }
    std::map<std::string, Points> finals;
    const auto fly = [&](int steps, int iterations, box2d::Hinge hinge) {
      const bool pair = hinge == box2d::Hinge::spring_pair;
      const std::string name = std::string(pair ? "3 spring pair" : "2 soft weld") + ", t0/" +
                               std::to_string(steps) + ", " + std::to_string(iterations) +
                               " iterations";
      box2d::Options options;
      options.hinge = hinge;
      options.velocity_iterations = iterations;
      const auto start = Clock::now();
      Points final = Points::Constant(2, problem.chain().particles(), std::nan(""));
      try {
        final =
            rollout(*box2d::make_backend_with(options, with_time_step(problem, t0 / steps)), gain)
                .final;
      } catch (const InputError&) {  // bent beyond the pair's range from the start
      }
      const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
      add(name, gap(final, fine), seconds);
      return final;
    };
    const auto weld = box2d::Hinge::soft_weld;
    const Points coarse = fly(1000, 8, weld);
    const Points middle = fly(2000, 8, weld);
    fly(1000, 16, weld);
    fly(2000, 16, weld);
    fly(4000, 16, weld);
    fly(1000, 8, box2d::Hinge::spring_pair);
    fly(2000, 16, box2d::Hinge::spring_pair);
    add("4 soft weld, extrapolated from t0/1000 and t0/2000", gap((4 * middle - coarse) / 3, fine),
        0);
    const int stiffness = static_cast<int>(scene.cloth.stretch_stiffness);
    add("5 EA = " + std::to_string(stiffness) + " N, soft weld, t0/1000, 8 iterations",
        gap(coarse, fine), 0);
    add("6 default against default", gap(coarse, usual.final), 0);
  }
};

}  // namespace
}  // namespace nuno

int main() {
  nuno::Study study;
  for (const nuno::ChainScene& scene : nuno::scene_library::family(64)) {
    if (scene.launch == nuno::Launch::inextensible) study.visit(scene);
  }
  std::printf(
      "| | scenes | median | 95th percentile | worst | a flight |\n|---|---|---|---|---|---|\n");
  for (const auto& [name, column] : study.columns) print_row(name.substr(2), column);
}
