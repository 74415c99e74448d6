#pragma once

#include <nuno/points.h>

#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace nuno {

/// Bad input of a user: the message names the file, the field, the value and the rule it broke.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// What numbers of a scene may be: far outside what a cloth can be, and far inside what doubles can
/// square and multiply.
inline constexpr double largest_scene_number = 1e12;
inline constexpr double smallest_scene_number = 1e-12;  ///< of those that are > 0
/// The least length of a shape over its distance from the origin: below it, coordinates cannot tell
/// the cloth's points apart.
inline constexpr double smallest_relative_length = 1e-9;

/// How the particles start.
enum class Launch {
  ballistic,    ///< each particle flies alone to its own target point (equations 1 and 2)
  inextensible  ///< those velocities, moved the least so that no segment changes its length
};

/// What the control force pulls towards.
enum class Reference {
  hold,  ///< the paper's: the target shape from the first step on (equation 3)
  morph  ///< a motion from the initial shape to the target, see reference_motion.h
};

/// How a moving reference comes to the target.
enum class Arrival {
  pass,   ///< in full swing
  settle  ///< with the shape at rest
};

/// What happens to a target whose drawn length is not the cloth's.
enum class TargetLength {
  fit,      ///< scaled about its centroid until its segments sum to the cloth's length
  as_drawn  ///< left as it is
};

/// Which end of a drawn target is the cloth's first.
enum class TargetOrder {
  as_drawn,  ///< where the line begins
  reversed   ///< where it ends
};

/// What an animator asks of a cloth, whatever its form. Lengths in metres, y up, SI throughout.
struct Scene {
  std::string name;
  double arrival_time = 0;   ///< t₀ [s], > 0; has no default
  double gravity = 9.80665;  ///< downward [m/s²], ≥ 0
  Launch launch = Launch::ballistic;
  Reference reference = Reference::hold;
  Arrival arrival = Arrival::pass;  ///< used by `morph`
  double damping_ratio = 0;         ///< ζ of the control force, ≥ 0, see shape_control.h
  TargetLength target_length = TargetLength::fit;
  std::optional<double> time_step;  ///< [s], > 0; absent: the engine chooses
  double frames_per_second = 60;    ///< frames kept of a rollout [1/s], > 0
};

/// Material of a whole chain. Control never changes a value here.
struct ChainMaterial {
  double mass = 0.1;               ///< M [kg], > 0; each particle has M/N
  double air_drag = 0.05;          ///< K [kg/s], ≥ 0; each particle has K/N
  double stretch_stiffness = 200;  ///< EA [N], > 0; segment i has the spring EA/ℓᵢ
  double stretch_damping = 6e-4;   ///< ηA [N·s], ≥ 0; segment i has the dashpot ηA/ℓᵢ
  double hinge_stiffness = 1e-3;   ///< EI [N·m²], ≥ 0; hinge i has the moment EI·θ/ℓ̄ᵢ
  double hinge_damping = 0;  ///< ηI [N·m²·s], ≥ 0; hinge i has the moment ηI·θ̇/ℓ̄ᵢ
};

/// A chain in the plane: both shapes are drawn as lines.
struct ChainScene : Scene {
  Index particles = 32;  ///< N, 3 … 1 000 000
  Points initial;        ///< drawn polyline [2 × any], at least 2 distinct points
  Points target;         ///< drawn polyline [2 × any], at least 2 distinct points
  TargetOrder target_order = TargetOrder::as_drawn;
  ChainMaterial cloth;
};

/// The faces of a mesh: each the vertices around it, 3 of a triangle, 4 of a quad.
using Faces = std::vector<std::vector<Index>>;

/// Material of a sheet, per area or width, so that it does not change with the mesh. Control never
/// changes a value here.
struct SheetMaterial {
  double areal_density = 0.15;      ///< ρ [kg/m²], > 0
  double air_drag = 0.05;           ///< [kg/(s·m²)], ≥ 0
  double stretch_stiffness = 500;   ///< S [N/m], > 0; an edge's spring has S·a/ℓ², see sheet.h
  double stretch_damping = 0.005;   ///< [N·s/m], ≥ 0; an edge's dashpot has it·a/ℓ²
  double shear_stiffness = 100;     ///< [N/m], ≥ 0, of the diagonals of quads
  double shear_damping = 0.001;     ///< [N·s/m], ≥ 0
  double bending_stiffness = 1e-4;  ///< B [N·m], ≥ 0; a hinge has 3·B·|e|²/(A₀ + A₁)
  double bending_damping = 0;       ///< [N·m·s], ≥ 0
};

/// What a sheet's hinges are at rest at.
enum class Rest {
  initial,  ///< the angles of the initial shape
  flat      ///< flat
};

/// A sheet in space: a mesh in two poses.
struct SheetScene : Scene {
  Points initial;  ///< the vertices [3 × N]
  Points target;   ///< the same vertices in the target's pose [3 × N]
  Faces faces;     ///< triangles and quads of the N vertices, a single connected sheet
  SheetMaterial cloth;
  Rest rest = Rest::initial;
};

/// Throws InputError if a value breaks its rule; `source` names the file in the message.
/// A sheet's faces are a single one, which may have holes, of faces that have an area in the
/// initial shape (quads convex), one or two at every edge, every vertex in one of them. Which way
/// round a face runs does not matter.
void validate(const ChainScene& scene, const std::string& source);
void validate(const SheetScene& scene, const std::string& source);

}  // namespace nuno
