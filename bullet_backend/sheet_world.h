#pragma once

#include "unit_sheet.h"

#include <memory>

namespace nuno::bullet {

/// A sheet as a soft body in Bullet's deformable world, in the units of UnitSheet.
class SheetWorld {
 public:
  /// Bullet gets these positions and velocities [3 × N], which must be finite.
  SheetWorld(const UnitSheet& sheet, const Points& positions, const Points& velocities);
  ~SheetWorld();

  /// A step under these forces [3 × N], which must be finite. Says whether Bullet could take it:
  /// if not, the world is where it was.
  bool step(const Points& forces, const Kick& kick);

  void read(Points& positions, Points& velocities) const;

 private:
  struct World;
  std::unique_ptr<World> world_;
};

}  // namespace nuno::bullet
