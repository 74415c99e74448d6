#pragma once

#include <nuno/sheet.h>

#include <stop_token>
#include <variant>
#include <vector>

namespace nuno {

/// Whoever asked for the work does not want it any more, see Problem::stop.
struct Stopped {};

/// A validated scene: throw this cloth so that it has this shape, there, then.
struct Problem {
  std::variant<Chain, Sheet> form;
  Points target;            ///< [d × N], m, at the size that the scene asks for
  double target_scale = 1;  ///< what `fit` did to the drawn target
  double arrival_time = 0;  ///< t₀ [s]
  Launch launch = Launch::ballistic;
  Reference reference = Reference::hold;
  Arrival arrival = Arrival::pass;
  double damping_ratio = 0;         ///< ζ of the control force
  std::optional<double> time_step;  ///< that the scene asks for [s]; absent: the engine chooses
  /// What is added to the reference motion, a shape [d × N], m, for each of
  /// correction_powers (reference_motion.h); empty: not at all.
  std::vector<Points> reference_correction;
  /// Once it is requested, whatever flies this problem throws Stopped within a step.
  std::stop_token stop = {};

  void stop_where_asked() const {
    if (stop.stop_requested()) throw Stopped();
  }

  /// The cloth, whatever its form.
  const Cloth& cloth() const {
    return std::visit([](const Cloth& any) -> const Cloth& { return any; }, form);
  }
  bool is_sheet() const { return std::holds_alternative<Sheet>(form); }
  /// The form itself; the problem must have it.
  const Chain& chain() const { return std::get<Chain>(form); }
  Chain& chain() { return std::get<Chain>(form); }
  const Sheet& sheet() const { return std::get<Sheet>(form); }
  Sheet& sheet() { return std::get<Sheet>(form); }
};

/// Throws InputError for a scene that is not valid, or has a segment of no length; `source` names
/// the scene's file in the message, its name does without.
Problem make_problem(const ChainScene& scene, std::string source = {});
Problem make_problem(const SheetScene& scene, std::string source = {});

/// The same problem at another time step [s]; without one the engine chooses.
Problem with_time_step(Problem problem, std::optional<double> time_step);

}  // namespace nuno
