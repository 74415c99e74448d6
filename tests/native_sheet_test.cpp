// The native engine's sheet against exact predictions.

#include <nuno/launch.h>
#include <nuno/native.h>
#include <nuno/rollout.h>
#include <nuno/shape_control.h>

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "sheets.h"

namespace nuno {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;

double stored_energy(const Sheet& sheet, const Points& x) {
  double energy = 0;
  for (const Springs* springs : {&sheet.stretch, &sheet.shear}) {
    for (Index e = 0; e < springs->count(); ++e) {
      const double length = (x.col(springs->ends(1, e)) - x.col(springs->ends(0, e))).norm();
      energy += 0.5 * springs->stiffness[e] * std::pow(length - springs->rest_length[e], 2);
    }
  }
  for (Index h = 0; h < sheet.hinges.count(); ++h) {
    const double turn = std::remainder(
        dihedral_angle(x, sheet.hinges.corners.col(h)) - sheet.hinges.rest_angle[h], 2 * pi);
    energy += 0.5 * sheet.hinges.stiffness[h] * turn * turn;
  }
  return energy;
}

double moving_energy(const Sheet& sheet, const Points& v) {
  return 0.5 * sheet.particle_mass * v.colwise().squaredNorm().dot(sheet.relative_mass);
}

/// Two unequal triangles that meet in an edge of no simple direction, at the dihedral angle `turn`.
SheetScene hinge(double turn) {
  SheetScene scene;
  scene.arrival_time = 1;
  scene.initial.resize(3, 4);
  scene.initial << 0, 1, 0.3, 0.6,  //
      0, 0, 0.8, -0.5 * std::cos(turn), 0, 0, 0, -0.5 * std::sin(turn);
  scene.initial =
      Eigen::AngleAxisd(0.7, Vector3d(1, 2, 3).normalized()).toRotationMatrix() * scene.initial;
  scene.target = scene.initial;
  scene.faces = {{0, 1, 2}, {1, 0, 3}};
  scene.gravity = 0;
  scene.cloth = without_losses();
  scene.cloth.bending_stiffness = 1;
  return scene;
}

/// What the first step of a sheet with these velocities does, as a force [3 × N], N: the first kick
/// lasts half of it.
Points first_force(Problem problem, const Points& velocity, double h) {
  problem.arrival_time = h;
  const auto backend = native::make_backend(with_time_step(problem, h));
  EXPECT_EQ(backend->steps(), 1);
  const auto sheet = backend->start(velocity);
  sheet->step(Points::Zero(3, velocity.cols()));
  const Points change = (sheet->velocities() - velocity) / (0.5 * h);
  return problem.cloth().particle_mass *
         (change.array().rowwise() * problem.cloth().relative_mass.transpose().array()).matrix();
}

TEST(NativeSheet, BendsAHingeByTheGradientOfItsEnergyAtAnyAngle) {
  for (const double turn : {-3.1, -2.4, -1.7, -0.9, -0.2, 0.0, 0.3, 0.8, 1.5, 2.2, 3.0}) {
    for (const double rest : {0.0, 0.5, -2.5}) {
      Problem problem = make_problem(hinge(turn));
      Sheet& sheet = problem.sheet();
      ASSERT_NEAR(dihedral_angle(sheet.initial, sheet.hinges.corners.col(0)), turn, 1e-12);
      sheet.hinges.rest_angle[0] = rest;
      sheet.stretch.rest_length *= 0.999;  // stretched, so that tension shows
      const Points force = first_force(problem, Points::Zero(3, 4), 1e-9);
      for (Index i = 0; i < force.size(); ++i) {
        Points ahead = sheet.initial, behind = sheet.initial;
        ahead.data()[i] += 1e-5;
        behind.data()[i] -= 1e-5;
        const double expected =
            -(stored_energy(sheet, ahead) - stored_energy(sheet, behind)) / 2e-5;
        // Forces are up to 100 N. Central differences: 1e-10/6 of third derivatives of order 1e3,
        // and rounding 1e-14/1e-5.
        EXPECT_NEAR(force.data()[i], expected, 1e-6) << "turn " << turn << " rest " << rest;
      }
    }
  }
}

TEST(NativeSheet, BrakesByTheRatesOfLengthsAndAngles) {
  for (const double turn : {-2.4, -0.4, 0.9, 3.1}) {
    SheetScene scene = hinge(turn);
    scene.cloth.bending_stiffness = 0;
    scene.cloth.bending_damping = 0.02;
    scene.cloth.stretch_damping = 0.1;
    const Problem problem = make_problem(scene);
    const Sheet& sheet = problem.sheet();
    const Points velocity{{0.3, -0.2, 0.5, 0.1}, {0.1, 0.6, -0.4, 0.2}, {-0.3, 0.2, 0.2, 0.7}};
    const auto power = [&](const Points& along) {  // of the dashpots' forces on this velocity
      const double t = 1e-5;
      const Points there = sheet.initial + t * velocity, back = sheet.initial - t * velocity;
      const Points to = sheet.initial + t * along, from = sheet.initial - t * along;
      const auto rate = [&](auto&& measure, const Points& a, const Points& b) {
        return std::remainder(measure(a) - measure(b), 2 * pi) / (2 * t);
      };
      double sum = 0;
      for (Index e = 0; e < sheet.stretch.count(); ++e) {
        const auto length = [&](const Points& x) {
          return (x.col(sheet.stretch.ends(1, e)) - x.col(sheet.stretch.ends(0, e))).norm();
        };
        sum -= sheet.stretch.damping[e] * rate(length, there, back) * rate(length, to, from);
      }
      const auto angle = [&](const Points& x) {
        return dihedral_angle(x, sheet.hinges.corners.col(0));
      };
      return sum - sheet.hinges.damping[0] * rate(angle, there, back) * rate(angle, to, from);
    };
    const Points force = first_force(problem, velocity, 1e-6);
    for (Index i = 0; i < force.size(); ++i) {
      Points unit = Points::Zero(3, 4);
      unit.data()[i] = 1;
      // Forces are of order 0.1 N. A length is good to 3e-12 of itself, here over 1e-6 s and times
      // 0.1 N·s/m: 3e-7.
      EXPECT_NEAR(force.data()[i], power(unit), 1e-6) << "turn " << turn;
    }
  }
}

TEST(NativeSheet, FliesRigidlyByItsOwnRecurrence) {
  SheetScene scene = square(8, 0.6, false);
  scene.cloth.air_drag = 0.3;
  const auto backend = native::make_backend(make_problem(scene));
  const DragRecurrence r = backend->drag_recurrence();
  Vector3d x(0, 0, 0), v(3, 5, -1);
  const auto sheet = backend->start(v.replicate(1, scene.initial.cols()));
  const Points none = Points::Zero(3, scene.initial.cols());
  for (Index n = 0; n < backend->steps(); ++n) {
    sheet->step(none);
    v *= n == 0 ? r.r1 : r.r;
    v.y() -= (n == 0 ? r.q1 : r.q) * scene.gravity;
    x += r.h * v;
    const Points moved = sheet->positions() - scene.initial;
    // Rounding of positions of some metres, over thousands of substeps.
    ASSERT_LT((moved.colwise() - x).colwise().norm().maxCoeff(), 1e-11) << "step " << n;
  }
}

TEST(NativeSheet, BringsTheMassCentreHomeAtEveryGain) {
  for (const double drag : {0.0, 0.05, 1.0}) {
    SheetScene scene = throw_scene(false);
    scene.cloth.air_drag = drag;
    const auto backend = native::make_backend(make_problem(scene));
    for (const double times : {0.0, 1.0, 100.0, 10000.0}) {
      const Rollout flight = rollout(*backend, times * gain_scale(backend->problem()));
      ASSERT_EQ(flight.status, RolloutStatus::ok);
      // Rounding, a hundredth of the bar of 1e-9 L.
      EXPECT_LT(flight.error.centroid, 1e-11 * backend->cloth().size) << drag << ' ' << times;
    }
  }
}

/// ω·a²·√(ρ/D) of the lowest mode of a free square plate, which twists it.
double twisting_frequency(Index columns) {
  constexpr double side = 1;
  SheetScene scene = square(columns, side);
  scene.gravity = 0;
  scene.arrival_time = 3;
  scene.cloth = without_losses();
  scene.cloth.bending_stiffness = 0.01;
  scene.cloth.stretch_stiffness = scene.cloth.shear_stiffness = 20;
  const Problem problem = make_problem(scene);
  const Points& x = problem.cloth().initial;
  const Vector shape = (x.row(0).array() * x.row(2).array()).transpose();
  Points velocity = Points::Zero(3, x.cols());
  velocity.row(1) = 1e-4 * shape.transpose();
  const auto backend = native::make_backend(problem);
  const auto sheet = backend->start(velocity);
  const Points none = Points::Zero(3, x.cols());
  // The amplitude of the shape, in which other modes are nearly orthogonal.
  const Vector weight = shape.cwiseProduct(problem.cloth().relative_mass);
  double last = 0, first_crossing = 0, last_crossing = 0;
  int crossings = 0;
  for (Index n = 0; n < backend->steps(); ++n) {
    sheet->step(none);
    const double now = sheet->positions().row(1).dot(weight);
    if (last < 0 && now >= 0) {
      last_crossing = backend->time_step() * (static_cast<double>(n + 1) - now / (now - last));
      if (crossings++ == 0) first_crossing = last_crossing;
    }
    last = now;
  }
  // Squares: D = 3·B, and no Poisson's ratio (sheet.h).
  const double plate = std::sqrt(3 * scene.cloth.bending_stiffness / scene.cloth.areal_density);
  return 2 * pi * (crossings - 1) / (last_crossing - first_crossing) * side * side / plate;
}

TEST(NativeSheet, TwistsAsAFreeSquarePlate) {
  // By Ritz' method with Legendre polynomials up to the 13th, which at ν = 0.3 gives the 13.468
  // that Leissa's (1973) 13.489 bounds from above.
  constexpr double expected = 15.82263;
  double last_error = 0;
  for (const Index columns : {7, 13, 25}) {
    const double error = std::abs(twisting_frequency(columns) / expected - 1);
    if (last_error > 0) {
      EXPECT_LT(error, 0.6 * last_error) << columns;
    }
    last_error = error;
  }
  EXPECT_LT(last_error, 0.005);  // it is 0.0027, and falls fourfold with the mesh
}

TEST(NativeSheet, KeepsMomentumAndAngularMomentum) {
  SheetScene scene = throw_scene(false);
  scene.gravity = 0;
  scene.initial = scene.target;  // bent, so that hinges push too
  scene.rest = Rest::flat;
  scene.cloth = without_losses();
  scene.cloth.bending_stiffness = 1e-2;
  scene.cloth.stretch_stiffness = scene.cloth.shear_stiffness = 5;  // no substeps
  const Problem problem = make_problem(scene);
  const auto backend = native::make_backend(problem);
  const Sheet& sheet = problem.sheet();
  const Points none = Points::Zero(3, sheet.particles());
  Points velocity = none;
  for (Index i = 0; i < velocity.size(); ++i) velocity.data()[i] = std::sin(1.7 * double(i * i));
  const auto flight = backend->start(velocity);
  const auto momenta = [&] {
    Eigen::Matrix<double, 6, 1> sum = Eigen::Matrix<double, 6, 1>::Zero();
    for (Index i = 0; i < sheet.particles(); ++i) {
      const Vector3d p =
          sheet.particle_mass * sheet.relative_mass[i] * flight->velocities().col(i).head<3>();
      sum.head<3>() += p;
      sum.tail<3>() += flight->positions().col(i).head<3>().cross(p);
    }
    return sum;
  };
  // Of the leapfrog's own velocity, half a step behind: exact, from the first step on.
  const Points before = flight->positions();
  flight->step(none);
  ASSERT_LT((flight->positions() - before - backend->time_step() * flight->velocities()).norm(),
            1e-13)
      << "it has substeps";
  const auto start = momenta();
  for (Index n = 1; n < backend->steps(); ++n) flight->step(none);
  const double moved = stored_energy(sheet, flight->positions());
  ASSERT_GT(moved, 1e-3);
  // A sum of some hundredths N·s (·m), rounded over a thousand steps.
  EXPECT_LT((momenta() - start).norm(), 1e-13);
}

TEST(NativeSheet, LosesNoEnergyWithoutDamping) {
  SheetScene scene = throw_scene(false);
  scene.gravity = 0;
  scene.initial = scene.target;  // rolled up, and it springs open
  scene.rest = Rest::flat;
  scene.cloth = without_losses();
  scene.cloth.bending_stiffness = 1e-3;
  double last_error = 0;
  for (const double h : {2.5e-4, 1.25e-4, 6.25e-5}) {
    const Problem problem = with_time_step(make_problem(scene), h);
    const auto backend = native::make_backend(problem);
    const Sheet& sheet = problem.sheet();
    const Points none = Points::Zero(3, sheet.particles());
    const auto flight = backend->start(none);
    const double start = stored_energy(sheet, sheet.initial);
    double error = 0;
    Points x = flight->positions(), v = flight->velocities();
    for (Index n = 0; n < backend->steps(); ++n) {
      flight->step(none);
      const Points mean = 0.5 * (v + flight->velocities());  // where x was
      if (n > 0) {
        error = std::max(
            error, std::abs(moving_energy(sheet, mean) + stored_energy(sheet, x) - start) / start);
      }
      x = flight->positions();
      v = flight->velocities();
    }
    if (last_error > 0) {
      EXPECT_LT(error, 0.4 * last_error) << h;
    }
    last_error = error;
  }
  EXPECT_LT(last_error, 1e-5);  // it is 2e-6, and falls fourfold with every halved step
}

TEST(NativeSheet, IsOfSecondOrder) {
  for (const double times : {0.0, 1.0, 10.0}) {
    SheetScene scene = throw_scene(false);
    scene.damping_ratio = 0;
    scene.reference = Reference::hold;  // which pulls from the first step on
    const Problem problem = make_problem(scene);
    std::vector<Points> finals;
    for (const double h : {1.0 / 800, 1.0 / 1600, 1.0 / 3200}) {
      const auto backend = native::make_backend(with_time_step(problem, h));
      EXPECT_NEAR(backend->time_step(), h, 1e-15);
      // One launch for all, so that the steps alone tell.
      const auto flight = backend->start(launch(*native::make_backend(problem)));
      const ShapeControl law(problem, times * gain_scale(problem));
      ReferenceMotion reference(problem, h);
      Points pulls = Points::Zero(3, scene.initial.cols()), forces = pulls;
      for (Index n = 0; n < backend->steps(); ++n) {
        law.pull(reference, flight->positions(), flight->velocities(), pulls);
        law.to_forces(pulls, forces);
        flight->step(forces);
        reference.advance();
      }
      finals.push_back(problem.cloth().shape_of(flight->positions()));
    }
    const double order = std::log2((finals[0] - finals[1]).norm() / (finals[1] - finals[2]).norm());
    EXPECT_NEAR(order, 2, 0.2) << "gain × " << times;
  }
}

TEST(NativeSheet, FliesTheSameTurnedMirroredAndRenumbered) {
  for (const bool all_quads : {true, false}) {
    const SheetScene scene = throw_scene(all_quads);
    const Problem problem = make_problem(scene);
    const double gain = 100 * gain_scale(problem);
    const auto fly = [&](const SheetScene& other) {
      const Rollout flight = rollout(*native::make_backend(make_problem(other)), gain);
      EXPECT_EQ(flight.status, RolloutStatus::ok);
      return flight.final;
    };
    const Points plain = fly(scene);
    // Rounding of 1e-15, which such a flight hardly lets grow.
    constexpr double rounding = 1e-11;

    SheetScene turned = scene;
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(1.1, Vector3d::UnitY()).toRotationMatrix();
    turned.initial = turn * scene.initial;
    turned.target = turn * scene.target;
    EXPECT_LT(farthest(fly(turned), turn * plain), rounding);

    SheetScene mirrored = scene;
    mirrored.initial.row(2) *= -1;
    mirrored.target.row(2) *= -1;
    Points mirror = plain;
    mirror.row(2) *= -1;
    EXPECT_LT(farthest(fly(mirrored), mirror), rounding);

    SheetScene renumbered = scene;
    const Index n = scene.initial.cols();
    const auto to = [n](Index i) { return (i * 35 + 11) % n; };  // 35 and 81 share no factor
    for (Index i = 0; i < n; ++i) {
      renumbered.initial.col(to(i)) = scene.initial.col(i);
      renumbered.target.col(to(i)) = scene.target.col(i);
    }
    for (auto& face : renumbered.faces) {
      for (Index& corner : face) corner = to(corner);
      std::rotate(face.begin(), face.begin() + 1, face.end());
    }
    std::reverse(renumbered.faces.begin(), renumbered.faces.end());
    const Points found = fly(renumbered);
    for (Index i = 0; i < n; ++i) EXPECT_LT((found.col(to(i)) - plain.col(i)).norm(), rounding);
  }
}

TEST(NativeSheet, GivesInLanesWhatItGivesAlone) {
  for (const double damping_ratio : {0.0, 0.7}) {
    SheetScene scene = throw_scene(false);
    scene.damping_ratio = damping_ratio;
    scene.cloth.bending_damping = 1e-6;
    const auto backend = native::make_backend(make_problem(scene));
    const double unit = gain_scale(backend->problem());
    std::vector<double> gains;
    for (int i = 0; i < 11; ++i) gains.push_back(unit * i * i);
    const std::vector<double> errors = backend->errors(gains);
    const std::vector<ErrorSample> samples = backend->error_samples(gains);
    for (std::size_t i = 0; i < gains.size(); ++i) {
      const double alone = rollout(*backend, gains[i]).error.mean;
      EXPECT_EQ(errors[i], alone);
      EXPECT_EQ(samples[i].error, alone);
    }
    for (std::size_t i = 1; i < gains.size(); ++i) {
      const double step = 1e-4 * gains[i];
      const std::vector<double> beside =
          backend->errors(std::vector<double>{gains[i] - step, gains[i] + step});
      const double expected = (beside[1] - beside[0]) / (2 * step);
      // Central differences: 1e-8 of α²·E''', which undamped control makes a few thousand times E'.
      EXPECT_NEAR(samples[i].derivatives.front().error, expected,
                  1e-4 * std::abs(expected) + 1e-6 * samples[i].error / gains[i])
          << gains[i] / unit << " m/t₀², ζ " << damping_ratio;
    }
  }
}

TEST(NativeSheet, ObeysATimeStepThatIsStableAndCutsOneThatIsNot) {
  SheetScene scene = throw_scene();
  for (const double wish : {3.3e-4, 1e-4}) {
    scene.time_step = wish;
    const auto backend = native::make_backend(make_problem(scene));
    EXPECT_EQ(backend->steps(), static_cast<Index>(std::ceil(1 / wish)));
  }
  scene.time_step = 0.5;
  scene.cloth.bending_stiffness = 0.1;
  const auto backend = native::make_backend(make_problem(scene));
  EXPECT_LT(backend->time_step(), 0.01);
  // Unstable hinges rattle without tearing: what they do to the arrival tells.
  const double gain = 300 * gain_scale(backend->problem());
  scene.time_step = 1e-4;
  const auto fine = native::make_backend(make_problem(scene));
  EXPECT_LT(farthest(rollout(*backend, gain).final, rollout(*fine, gain).final),
            0.02 * backend->cloth().size);
}

TEST(NativeSheet, RefusesMoreStepsThanAFlightMayTake) {
  const auto message = [](const SheetScene& scene) {
    try {
      native::make_backend(make_problem(scene));
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("not refused");
  };
  SheetScene scene = throw_scene();
  scene.cloth.stretch_stiffness = 1e12;
  scene.arrival_time = 1e3;
  EXPECT_TRUE(message(scene).starts_with("/cloth/stretch_stiffness: 1000000000000 takes"))
      << message(scene);
  scene = throw_scene();
  scene.cloth.bending_damping = 1e3;
  EXPECT_TRUE(message(scene).starts_with("/cloth/bending_damping: 1000 takes")) << message(scene);
}

TEST(NativeSheet, SaysThatItDiverged) {
  const auto backend = native::make_backend(make_problem(throw_scene()));
  const double gain = 1000 * backend->largest_gain();
  const Rollout flight = rollout(*backend, gain);
  EXPECT_EQ(flight.status, RolloutStatus::diverged);
  EXPECT_NE(flight.reason, "");
  const std::vector<double> gains = {gain, 0, gain};
  const std::vector<ErrorSample> samples = backend->error_samples(gains);
  for (const std::size_t i : {0u, 2u}) {
    EXPECT_EQ(backend->errors(gains)[i], std::numeric_limits<double>::infinity());
    EXPECT_EQ(samples[i].error, std::numeric_limits<double>::infinity());
    EXPECT_EQ(samples[i].derivatives.front().error, 0);
  }
  EXPECT_TRUE(std::isfinite(samples[1].error));
}

}  // namespace
}  // namespace nuno
