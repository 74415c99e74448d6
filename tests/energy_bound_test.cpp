// A flight has no more energy than its launch and its control give it.

#include <nuno/conditioning.h>
#include <nuno/engines.h>
#include <nuno/launch.h>
#include <nuno/reference_motion.h>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <random>
#include <string>
#include <vector>

namespace nuno {
namespace {

/// A chain of 8 to 64 particles that is 1 cm to 10 m long, light or heavy, limp or stiff, from one
/// smooth curve to another in 0.3 to 3 s.
class RandomScene {
 public:
  explicit RandomScene(unsigned seed) : random_(seed) {}

  ChainScene operator()() {
    ChainScene scene;
    scene.particles = static_cast<Index>(between(8, 64));
    scene.arrival_time = between(0.3, 3);
    scene.gravity = uniform() < 0.2 ? 0 : 9.8;
    const double length = between(0.01, 10);
    scene.initial = curve(length, Vector::Zero(2));
    scene.target = curve(length, length * Eigen::Vector2d(3 * uniform(), 2 * uniform()));
    scene.cloth.mass = between(0.02, 1);
    // Weights and lengths of the cloth give the forces their scale.
    const double weight = scene.cloth.mass * 9.8;
    scene.cloth.stretch_stiffness = weight * between(10, 1e5);
    scene.cloth.hinge_stiffness = weight * length * length * between(1e-6, 1e-2);
    scene.cloth.air_drag = uniform() < 0.3 ? 0 : scene.cloth.mass * between(0.02, 1);
    scene.reference = uniform() < 0.5 ? Reference::hold : Reference::morph;
    scene.damping_ratio = uniform() < 0.5 ? 0 : 0.7;
    scene.launch = uniform() < 0.5 ? Launch::ballistic : Launch::inextensible;
    return scene;
  }

 private:
  double uniform() { return std::uniform_real_distribution<double>(0, 1)(random_); }
  double between(double low, double high) { return low * std::pow(high / low, uniform()); }

  Points curve(double length, const Vector& from) {
    constexpr int points = 24;
    const double turn = 2 * std::numbers::pi * uniform();
    const double wave = 6 * (uniform() - 0.5), arc = 6 * (uniform() - 0.5);
    Points curve(2, points);
    curve.col(0) = from;
    for (int i = 1; i < points; ++i) {
      const double along = i / (points - 1.0);
      const double angle = turn + wave * std::sin(3 * along) + arc * along;
      curve.col(i) = curve.col(i - 1) +
                     length / (points - 1) * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    }
    return curve;
  }

  std::mt19937 random_;
};

/// What a flight's energy about its mass centre cannot exceed [J]. With o the offsets from the
/// reference r, the spring of the control holds ½α·|o|². Drag and dashpots take energy; a reference
/// that moves gives it at a rate of α·o·ṙ ≤ √(2αE)·|ṙ|, and the control's damping at one of at most
/// ¼β·|ṙ|², so that √E grows by no more than √(α/2)·∫|ṙ|dt.
double most_energy(const Backend& backend, double gain, const Points& launch_velocity) {
  const Problem& problem = backend.problem();
  const Chain& chain = problem.chain();
  const double mass = chain.particle_mass;
  ReferenceMotion reference(problem, backend.time_step());
  const Points start = shape_of(chain.initial);
  double energy = 0.5 * gain * (reference.shape() - start).squaredNorm() +
                  0.5 * mass * shape_of(launch_velocity).squaredNorm();
  for (Index i = 0; i + 2 < chain.particles(); ++i) {
    const Vector a = start.col(i + 1) - start.col(i), b = start.col(i + 2) - start.col(i + 1);
    const double angle = std::atan2(a[0] * b[1] - a[1] * b[0], a.dot(b));
    energy += 0.5 * chain.material.hinge_stiffness * angle * angle / chain.hinge_length[i];
  }
  double way = 0, squared = 0;  // ∫|ṙ|dt, ∫|ṙ|²dt
  for (Index step = 0; step < backend.steps(); ++step) {
    reference.advance();
    way += backend.time_step() * reference.velocity().norm();
    squared += backend.time_step() * reference.velocity().squaredNorm();
  }
  const double damping = 2 * problem.damping_ratio * std::sqrt(gain * mass);
  return std::pow(std::sqrt(energy + 0.25 * damping * squared) + std::sqrt(0.5 * gain) * way, 2);
}

/// The strain of a segment that holds all of this energy.
double most_strain(const Chain& chain, double energy) {
  return std::sqrt(2 * energy / (chain.material.stretch_stiffness * chain.rest_length.minCoeff()));
}

struct Counts {
  int flights = 0, told = 0, diverged = 0;
};

void judge(const SceneFile& file, const Backend& backend, double gain, Counts& counts) {
  const auto [finer, flight, growth] = judged_rollout(backend, file, gain);
  ++counts.flights;
  if (diverged(flight)) {
    ++counts.diverged;
    const auto quarter = at_finer_step(backend, file, 0.25);
    EXPECT_TRUE(!quarter || diverged(rollout(*quarter, gain)))
        << file.path << " on " << backend.name() << ": a quarter of the step does not diverge";
    return;
  }
  const Backend& flew = finer ? *finer : backend;
  if (!coarseness(flight, flew.time_step()).empty() || growth > largest_calm_sensitivity) {
    ++counts.told;
    return;
  }
  const double bound =
      most_strain(file.problem.chain(), most_energy(flew, gain, flight.launch_velocity));
  // Rods are not quite rigid, and less than that nobody sees.
  EXPECT_LE(flight.max_strain, std::max(1.2 * bound, largest_calm_strain))
      << file.path << " on " << backend.name() << ", α = " << gain << " N/m";
}

/// Random scenes; more of them with NUNO_RANDOM_SCENES.
unsigned scenes_wished() {
  const char* const wished = std::getenv("NUNO_RANDOM_SCENES");
  return wished ? static_cast<unsigned>(std::atoi(wished)) : 25;
}

class EnergyBound : public testing::TestWithParam<std::string_view> {};

TEST_P(EnergyBound, NoSegmentHoldsMoreThanTheWholeFlightOrAWordSaysSo) {
  Counts counts;
  for (unsigned seed = 0; seed < scenes_wished(); ++seed) {
    ChainScene scene = RandomScene(seed)();
    scene.name = "random-" + std::to_string(seed);
    const SceneFile file = make_scene_file(scene.name, scene);
    std::unique_ptr<Backend> backend;
    try {
      backend = make_backend(GetParam(), file);
    } catch (const InputError&) {  // one flight would take hours
      continue;
    }
    if (backend->steps() > 20000) continue;
    for (const double share : {1e-4, 1e-3, 1e-2, 0.1, 1.0}) {
      judge(file, *backend, share * backend->largest_gain(), counts);
    }
  }
  RecordProperty("flights", counts.flights);
  RecordProperty("told", counts.told);
  RecordProperty("diverged", counts.diverged);
  EXPECT_LT(2 * (counts.told + counts.diverged), counts.flights);  // or the bound judges little
}

/// A metre of stiff thread that nothing brakes, pulled together by its control alone.
struct Fold {
  Points target;
  Index particles;
  double stretch_stiffness;  // [N]
  double gain;               // [N/m]
};

/// A quarter folded back, and nearly all of a circle: 4.6 rad.
std::vector<Fold> folds() {
  const Points vee{{0, 0.5, 0}, {0, 0.1, 0.2}};
  Points curl(2, 33);
  for (Index i = 0; i < curl.cols(); ++i) {
    const double turn = 4.6 * static_cast<double>(i) / 32;
    curl.col(i) << std::sin(turn) / 4.6, (1 - std::cos(turn)) / 4.6;
  }
  return {{vee, 16, 2e4, 5}, {vee, 32, 2e4, 0.5}, {curl, 32, 200, 5}, {curl, 32, 2e4, 5}};
}

TEST_P(EnergyBound, HoldsWhereControlFoldsAStiffThread) {
  Counts counts;
  for (const Fold& fold : folds()) {
    ChainScene scene;
    scene.name = fmt::format("{} particles, EA {}", fold.particles, fold.stretch_stiffness);
    scene.particles = fold.particles;
    scene.arrival_time = 1;
    scene.gravity = scene.cloth.air_drag = 0;
    scene.initial = Points{{0, 1}, {1, 1}};
    scene.target = fold.target;
    scene.cloth.stretch_stiffness = fold.stretch_stiffness;
    const SceneFile file = make_scene_file(scene.name, scene);
    judge(file, *make_backend_for_gain(GetParam(), file, fold.gain), fold.gain, counts);
    EXPECT_EQ(counts.diverged, 0) << scene.name;
  }
  // Folded up and fragile, each of them has a word; at too long a step they diverge.
  EXPECT_EQ(counts.flights, 4);
}

INSTANTIATE_TEST_SUITE_P(EachOf, EnergyBound, testing::ValuesIn(chain_engines),
                         [](const auto& engine) { return std::string(engine.param); });

}  // namespace
}  // namespace nuno
