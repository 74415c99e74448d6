// The adjoint of a sheet's flight against differences of flights, and against exact predictions.

#include <nuno/launch.h>
#include <nuno/native.h>
#include <nuno/reference_motion.h>
#include <nuno/rollout.h>
#include <nuno/shape_control.h>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>

#include "sheets.h"

namespace nuno {
namespace {

/// Numbers of every wavelength, of the order 1 [rows × columns].
Points pattern(Index rows, Index columns, double seed) {
  Points points(rows, columns);
  for (Index i = 0; i < points.size(); ++i) {
    const double k = static_cast<double>(i + 1) + seed;
    points.data()[i] = std::sin(1.7 * k + 0.61803 * k * k);
  }
  return points;
}

struct Case {
  std::string name;
  SheetScene scene;
  double times = 30;  ///< the gain, in m̄/t₀²
};

/// A throw of few and long steps, in which everything that a sheet may have counts: substeps,
/// dashpots of springs and hinges, air.
SheetScene lively(Tiles tiles) {
  SheetScene scene = throw_scene(true, 5);
  const Mesh mesh = grid(5, 5, 0.2, tiles);
  scene.faces = mesh.faces;
  scene.arrival_time = 0.5;
  scene.time_step = 2.5e-3;
  scene.cloth.air_drag = 0.2;
  scene.cloth.stretch_stiffness = 1000;
  scene.cloth.stretch_damping = scene.cloth.shear_damping = 0.02;
  scene.cloth.bending_stiffness = 2e-3;
  scene.cloth.bending_damping = 2e-5;
  return scene;
}

std::vector<Case> cases() {
  std::vector<Case> cases = {{"quads", lively(Tiles::quads)},
                             {"triangles", lively(Tiles::triangles)},
                             {"mixed", lively(Tiles::mixed)}};
  const auto add = [&](const std::string& name, auto&& change, double times = 30) {
    cases.push_back({name, lively(Tiles::mixed), times});
    change(cases.back().scene);
  };
  add("without hinge dashpots", [](SheetScene& s) { s.cloth.bending_damping = 0; });
  add("without dashpots", [](SheetScene& s) {
    s.cloth.stretch_damping = s.cloth.shear_damping = s.cloth.bending_damping = 0;
  });
  add("undamped control", [](SheetScene& s) { s.damping_ratio = 0; });
  add("hold", [](SheetScene& s) { s.reference = Reference::hold; });
  add("hold, undamped control", [](SheetScene& s) {
    s.reference = Reference::hold;
    s.damping_ratio = 0;
  });
  add("settle", [](SheetScene& s) { s.arrival = Arrival::settle; });
  add("inextensible", [](SheetScene& s) { s.launch = Launch::inextensible; });
  add("no substeps",
      [](SheetScene& s) { s.cloth.stretch_stiffness = s.cloth.shear_stiffness = 4; });
  add("bent at the start", [](SheetScene& s) { s.initial = rolled(s.initial, 1.5); });
  add("bent at the start, flat at rest", [](SheetScene& s) {
    s.initial = rolled(s.initial, 1.5);
    s.rest = Rest::flat;
  });
  add(
      "launch only", [](SheetScene&) {}, 0);
  add("one step", [](SheetScene& s) { s.time_step = s.arrival_time = 2e-3; });
  return cases;
}

double dot(const Points& a, const Points& b) { return a.cwiseProduct(b).sum(); }

/// d/dε of `value` at 0, to fourth order: the error is of ε⁴.
template <typename Value>
double derivative(Value&& value, double size) {
  const auto central = [&](double e) { return (value(e) - value(-e)) / (2 * e); };
  return (4 * central(size / 2) - central(size)) / 3;
}

/// A problem, a quantity of its flight, and what the adjoint says of it: a random product with the
/// final positions, and effort.
struct Quantity {
  explicit Quantity(const Case& from, double effort_weight = 0.3)
      : problem(make_problem(from.scene)),
        backend(native::make_backend(problem)),
        gain(from.times * gain_scale(problem)),
        arrival(pattern(3, problem.cloth().particles(), 0.3)),
        effort(effort_weight),
        gradient(backend->gradient(gain, [&](const Points&) {
          return RolloutCotangent{arrival, effort};
        })) {}

  double of(const Points& final, double control_effort) const {
    return dot(arrival, final) + effort * control_effort * control_effort;
  }
  double flown(const Problem& other, double at_gain) const {
    const Rollout flight = rollout(*native::make_backend(other), at_gain);
    EXPECT_EQ(flight.status, RolloutStatus::ok);
    return of(flight.final, flight.control_effort);
  }

  Problem problem;
  std::unique_ptr<Backend> backend;
  double gain;
  Points arrival;
  double effort;
  RolloutGradient gradient;
};

// Differences of fourth order: about 1e-9 of the quantity, where rounding and truncation meet.
constexpr double of_differences = 1e-6;

TEST(SheetGradient, IsOfStepsWithAndWithoutSubsteps) {
  for (const Case& each : cases()) {
    const auto backend = native::make_backend(make_problem(each.scene));
    const Points& start = backend->cloth().initial;
    const auto sheet = backend->start(pattern(3, start.cols(), 0));
    sheet->step(Points::Zero(3, start.cols()));
    // A step without them moves at the velocity that it tells.
    const double off =
        farthest(sheet->positions(), start + backend->time_step() * sheet->velocities());
    EXPECT_EQ(off < 1e-14, each.name == "no substeps") << each.name << ' ' << off;
  }
}

TEST(SheetGradient, FliesWhatARolloutFlies) {
  for (const Case& each : cases()) {
    const Quantity quantity(each);
    const Rollout flight = rollout(*quantity.backend, quantity.gain);
    EXPECT_EQ(quantity.gradient.final, flight.final) << each.name;
    EXPECT_NEAR(std::sqrt(quantity.gradient.squared_effort), flight.control_effort,
                1e-12 * flight.control_effort)
        << each.name;
  }
}

TEST(SheetGradient, IsThatOfDifferencesByTheGain) {
  for (const Case& each : cases()) {
    const Quantity quantity(each);
    if (quantity.gain == 0) continue;  // there it may be infinite
    const double found = derivative(
        [&](double e) { return quantity.flown(quantity.problem, quantity.gain * (1 + e)); }, 1e-2);
    const double exact = quantity.gain * quantity.gradient.gain;
    // Of one step the cloth is on its reference, and no gain moves it: rounding of the differences.
    EXPECT_NEAR(exact, found, of_differences * std::abs(found) + 1e-12) << each.name;
  }
}

TEST(SheetGradient, IsThatOfDifferencesByReferenceCorrections) {
  for (const Case& each : cases()) {
    const Quantity quantity(each);
    for (std::size_t k = 0; k < correction_powers.size(); ++k) {
      const Points way = pattern(3, quantity.arrival.cols(), static_cast<double>(k));
      const double found = derivative(
          [&](double e) {
            Problem moved = quantity.problem;
            moved.reference_correction.assign(correction_powers.size(),
                                              Points::Zero(3, way.cols()));
            moved.reference_correction[k] = e * way;
            return quantity.flown(moved, quantity.gain);
          },
          1e-3);
      const double exact = dot(quantity.gradient.reference_correction[k], way);
      EXPECT_NEAR(exact, found, of_differences * std::abs(found) + 1e-9)
          << each.name << ", power " << correction_powers[k];
    }
  }
}

/// The flight from launch velocities of one's own, as `rollout` makes it.
double flown_from(const Quantity& quantity, const Points& launched) {
  const Backend& backend = *quantity.backend;
  const Problem& problem = quantity.problem;
  const ShapeControl control(problem, quantity.gain);
  ReferenceMotion reference(problem, backend.time_step());
  const auto flight = backend.start(launched);
  Points velocity = launched, told = launched, motion = reference.velocity();
  Points pulls = Points::Zero(3, launched.cols()), forces = pulls;
  double squared_force = 0;
  for (Index n = 0; n < backend.steps(); ++n) {
    control.pull(reference, flight->positions(), told, pulls);
    squared_force += pulls.squaredNorm();
    control.to_forces(pulls, forces);
    flight->step(forces);
    reference.advance();
    told = 1.5 * flight->velocities() - 0.5 * velocity - 0.5 * (reference.velocity() - motion);
    velocity = flight->velocities();
    motion = reference.velocity();
  }
  const double samples = static_cast<double>(backend.steps() * launched.cols());
  return quantity.of(flight->positions(),
                     std::sqrt(squared_force / samples) / effort_unit(problem));
}

TEST(SheetGradient, IsThatOfDifferencesByTheLaunch) {
  for (const Case& each : cases()) {
    const Quantity quantity(each);
    const Points launched = launch(*quantity.backend);
    const Points way = pattern(3, launched.cols(), 5);
    const double found =
        derivative([&](double e) { return flown_from(quantity, launched + e * way); }, 1e-3);
    const double exact = dot(quantity.gradient.launch, way);
    EXPECT_NEAR(exact, found, of_differences * std::abs(found)) << each.name;
  }
}

TEST(SheetGradient, OfTheMassCentreByCorrectionsIsZero) {
  for (const Case& each : cases()) {
    const Quantity quantity(each);
    const Points& x = quantity.arrival;
    const Points center = quantity.problem.cloth().relative_mass.transpose().replicate(3, 1) /
                          static_cast<double>(x.cols());
    const RolloutGradient gradient = quantity.backend->gradient(quantity.gain, center);
    for (const Points& correction : gradient.reference_correction) {
      EXPECT_LT(correction.cwiseAbs().maxCoeff(), 1e-13) << each.name;
    }
    EXPECT_LT(std::abs(quantity.gain * gradient.gain), 1e-13) << each.name;
  }
}

TEST(SheetGradient, AgreesWithTheTangentByTheGain) {
  for (const Case& each : cases()) {
    const Quantity quantity(each, 0);
    if (quantity.gain == 0) continue;
    const ErrorSample sample = quantity.backend->error_samples(std::array{quantity.gain}).front();
    const Points& tangent = sample.derivatives.front().residual;
    const double exact = dot(quantity.arrival, tangent);
    EXPECT_NEAR(quantity.gradient.gain, exact, 1e-12 * quantity.arrival.norm() * tangent.norm())
        << each.name;
    EXPECT_NEAR(quantity.backend->error_gradient(quantity.gain).gain,
                sample.derivatives.front().error,
                1e-12 * tangent.norm() / std::sqrt(static_cast<double>(tangent.cols())))
        << each.name;
  }
}

TEST(SheetGradient, OfAFlightThatDivergedIsNone) {
  const Problem problem = make_problem(throw_scene());
  const auto backend = native::make_backend(problem);
  const RolloutGradient gradient = backend->error_gradient(1000 * backend->largest_gain());
  EXPECT_TRUE(is_torn(problem.cloth(), gradient.final));
  EXPECT_EQ(gradient.gain, 0);
  EXPECT_EQ(gradient.launch.size(), 0);
  EXPECT_TRUE(gradient.reference_correction.empty());
}

}  // namespace
}  // namespace nuno
