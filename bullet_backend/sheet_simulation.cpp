#include "sheet_simulation.h"

#include "sheet_world.h"

#include <limits>
#include <optional>
#include <utility>

namespace nuno::bullet {
namespace {

using Eigen::Vector3d;

constexpr double largest_number = 1e30;  // still a number in single precision

// Why a flight ends before its time.
constexpr std::string_view wild_launch =
    "a particle is launched faster than Bullet is asked to move it: the sheet's size L per step "
    "about the mass centre";
constexpr std::string_view wild_start = "a particle starts too far off for single precision";
constexpr std::string_view wild_force = "a force is larger than Bullet can take in one step";
constexpr std::string_view wild_motion =
    "a particle gets faster than Bullet is asked to move it: the sheet's size L per step about "
    "the mass centre";

// The sheet flies about its mass centre in Bullet, see mass_center_flight.h: what acts there of the
// outer forces is what is left when each particle has had its share by mass of their sum taken off.
class SheetSimulation final : public Simulation {
 public:
  SheetSimulation(const UnitSheet& sheet, MassCenterFlight center, const Points& positions,
                  const Points& velocities)
      : sheet_(sheet),
        center_(std::move(center)),
        forces_(3, positions.cols()),
        positions_(positions),
        velocities_(velocities) {
    const Points x = shape_of(positions, sheet.mass) / sheet.unit_length;
    const Points v = shape_of(velocities, sheet.mass) * (sheet.h / sheet.unit_length);
    if (!positions.allFinite() || !x.allFinite() || !(x.cwiseAbs().maxCoeff() < most_apart)) {
      give_up(wild_start);
    } else if (!v.allFinite() || !(v.colwise().norm().maxCoeff() < 1)) {
      give_up(wild_launch);
    } else {
      world_.emplace(sheet, x, v);
    }
  }

  void step(const Points& forces) override {
    if (!failure_.empty()) return;
    const Kick& kick = first_ ? sheet_.first : sheet_.other;
    forces_ = forces / sheet_.unit_force;
    if (!forces_.allFinite() || !(forces_.cwiseAbs().maxCoeff() < largest_number)) {
      return give_up(wild_force);
    }
    const Vector3d mean = forces_.rowwise().mean();
    forces_ -= mean * sheet_.mass.transpose();
    if (!world_->step(forces_, kick)) return give_up(wild_motion);
    center_.step(sheet_.unit_force * mean);
    read();
    first_ = false;
  }

  const Points& positions() const override { return positions_; }
  const Points& velocities() const override { return velocities_; }
  std::string_view failure() const override { return failure_; }

 private:
  static constexpr double most_apart = 1e5;  // sizes L

  void read() {
    world_->read(positions_, velocities_);
    if (!(positions_.cwiseAbs().maxCoeff() < most_apart)) return give_up(wild_motion);
    // Off with the rounding that the mass centre has gathered there.
    const Vector3d moved = mass_center(positions_, sheet_.mass);
    const Vector3d drift = mass_center(velocities_, sheet_.mass);
    positions_ =
        (sheet_.unit_length * (positions_.colwise() - moved)).colwise() + center_.position();
    const double unit_velocity = sheet_.unit_length / sheet_.h;
    velocities_ = (unit_velocity * (velocities_.colwise() - drift)).colwise() + center_.velocity();
  }

  /// Bullet sees nothing of this cloth from now on.
  void give_up(std::string_view reason) {
    failure_ = reason;
    positions_.setConstant(std::numeric_limits<double>::quiet_NaN());
    velocities_.setConstant(std::numeric_limits<double>::quiet_NaN());
  }

  const UnitSheet& sheet_;
  std::optional<SheetWorld> world_;  // none for a launch that Bullet is not asked to take
  MassCenterFlight center_;
  Points forces_;
  Points positions_, velocities_;
  std::string_view failure_;  // empty: Bullet flies this cloth
  bool first_ = true;
};

}  // namespace

std::unique_ptr<Simulation> make_simulation(const UnitSheet& sheet, const MassCenterFlight& center,
                                            const Points& positions, const Points& velocities) {
  return std::make_unique<SheetSimulation>(sheet, center, positions, velocities);
}

}  // namespace nuno::bullet
