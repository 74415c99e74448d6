#include <nuno/feasibility.h>

#include <fmt/format.h>

#include <nuno/launch.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

namespace nuno {
namespace {

/// Largest turn of a segment from the initial shape to the target, relative to the mean [rad].
double turning(const Chain& chain, const Points& target) {
  Vector turns(chain.rest_length.size());
  for (Index i = 0; i < turns.size(); ++i) {
    const Eigen::Vector2d before = chain.initial.col(i + 1) - chain.initial.col(i);
    const Eigen::Vector2d after = target.col(i + 1) - target.col(i);
    turns[i] = std::atan2(before.x() * after.y() - before.y() * after.x(), before.dot(after));
    if (i > 0) {
      turns[i] = turns[i - 1] + std::remainder(turns[i] - turns[i - 1], 2 * std::numbers::pi);
    }
  }
  return (turns.array() - turns.mean()).abs().maxCoeff();
}

/// What the target asks of a sheet's edges and of the angles between its triangles.
void assess_shape(const Sheet& sheet, const Points& target, Feasibility& result) {
  std::map<std::pair<Index, Index>, int> faces_at;
  for (const auto& face : sheet.faces) {
    for (std::size_t i = 0; i < face.size(); ++i) {
      ++faces_at[std::minmax(face[i], face[(i + 1) % face.size()])];
    }
  }
  for (Index e = 0; e < sheet.edges.cols(); ++e) {
    const Index a = sheet.edges(0, e), b = sheet.edges(1, e);
    const double ratio = (target.col(b) - target.col(a)).stableNorm() / sheet.rest_length[e];
    EdgeMismatch& mismatch = faces_at[std::minmax(a, b)] == 1 ? result.border : result.inside;
    mismatch.too_long = std::max(mismatch.too_long, ratio - 1);
    mismatch.too_short = std::max(mismatch.too_short, 1 - ratio);
  }
  for (Index h = 0; h < sheet.hinges.count(); ++h) {
    const auto corners = sheet.hinges.corners.col(h);
    const double change = dihedral_angle(target, corners) - dihedral_angle(sheet.initial, corners);
    result.folding =
        std::max(result.folding, std::abs(std::remainder(change, 2 * std::numbers::pi)));
  }
  result.is_sheet = true;
}

/// "19.6 % too long along its border and 2.0 % too short", of what is worth saying.
std::string in_words(const EdgeMismatch& border, const EdgeMismatch& inside) {
  std::string words;
  const auto say = [&](double at_border, double within, std::string_view what) {
    const double worst = std::max(at_border, within);
    if (!(worst > 1e-2)) return;
    // Where it is as bad at either, no place is worth a word.
    const char* const place = at_border > 1.1 * within   ? " along its border"
                              : within > 1.1 * at_border ? " inside"
                                                         : "";
    words += fmt::format("{}{:.1f} % {}{}", words.empty() ? "" : " and ", 100 * worst, what, place);
  };
  say(border.too_long, inside.too_long, "too long");
  say(border.too_short, inside.too_short, "too short");
  return words;
}

}  // namespace

// A segment that stretches at the rate u stops when the thread's energy ½·EA·ε²·ℓ has taken up the
// kinetic ½·(m/2)·(u·ℓ)² of its two ends: ε = u·√(m·ℓ/(2·EA)). Neighbours that stretch alike share
// a longer way: over the whole cloth ε = u·L/c at most, c = √(EA·L/M) the speed of sound.
Feasibility assess(const Backend& backend) {
  const Problem& problem = backend.problem();
  const Cloth& cloth = problem.cloth();
  const Points velocities = launch(backend);

  Feasibility result;
  result.time_step = backend.time_step();
  result.steps = backend.steps();
  result.launch_speed = velocities.colwise().norm().maxCoeff();
  for (Index e = 0; e < cloth.rest_length.size(); ++e) {
    const Index a = cloth.edges(0, e), b = cloth.edges(1, e);
    const double target_length = (problem.target.col(b) - problem.target.col(a)).stableNorm();
    const Vector before = cloth.initial.col(b) - cloth.initial.col(a);
    const Vector apart = velocities.col(b) - velocities.col(a);
    result.length_mismatch =
        std::max(result.length_mismatch, std::abs(target_length / cloth.rest_length[e] - 1));
    result.launch_stretching = std::max(
        result.launch_stretching, std::abs(before.normalized().dot(apart)) / cloth.rest_length[e]);
  }
  if (problem.is_sheet()) {
    assess_shape(problem.sheet(), problem.target, result);
  } else {
    result.turning = turning(problem.chain(), problem.target);
  }
  result.launch_strain = result.launch_stretching * cloth.size / cloth.sound_speed;
  return result;
}

std::string verdict(const Feasibility& feasibility) {
  std::string words;
  const auto say = [&](const std::string& sentence) {
    words += (words.empty() ? "" : "\n") + sentence;
  };
  if (feasibility.length_mismatch > 1e-2 && feasibility.is_sheet) {
    say(fmt::format("The target is {}: the cloth comes near, not onto it.",
                    in_words(feasibility.border, feasibility.inside)));
  } else if (feasibility.length_mismatch > 1e-2) {
    say(fmt::format(
        "The target's segments differ from the cloth's by up to {:.1f} %: the cloth comes "
        "near, not onto it.",
        100 * feasibility.length_mismatch));
  }
  if (feasibility.folding > 0.5 * std::numbers::pi) {
    say(fmt::format(
        "The target folds by {:.0f}° at an edge, too sharp for this mesh: smaller faces "
        "there would make a fold of many edges.",
        feasibility.folding * 180 / std::numbers::pi));
  }
  if (feasibility.launch_strain > 2e-2) {
    say(
        fmt::format("The launch stretches the cloth by some {:.0f} % before it pulls back: "
                    "\"launch\": \"inextensible\" does not.",
                    100 * feasibility.launch_strain));
  }
  if (feasibility.turning > 2 * std::numbers::pi) {
    say(fmt::format("A part of the cloth turns {:.1f} times against the rest on the way.",
                    feasibility.turning / (2 * std::numbers::pi)));
  }
  if (feasibility.steps > 100'000) {
    say(fmt::format("The {} a flight takes {} steps.",
                    feasibility.is_sheet ? "cloth is so stiff, or so light, for edges so short that"
                                         : "hinges are so stiff for segments so short that",
                    feasibility.steps));
  }
  return words;
}

}  // namespace nuno
