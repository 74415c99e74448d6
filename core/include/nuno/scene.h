#pragma once

#include <nuno/points.h>

#include <optional>
#include <stdexcept>
#include <string>

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

/// Material of the whole cloth. Control never changes a value here.
struct Cloth {
  double mass = 0.1;               ///< M [kg], > 0; each particle has M/N
  double air_drag = 0.05;          ///< K [kg/s], ≥ 0; each particle has K/N
  double stretch_stiffness = 200;  ///< EA [N], > 0; segment i has the spring EA/ℓᵢ
  double stretch_damping = 6e-4;   ///< ηA [N·s], ≥ 0; segment i has the dashpot ηA/ℓᵢ
  double hinge_stiffness = 1e-3;   ///< EI [N·m²], ≥ 0; hinge i has the moment EI·θ/ℓ̄ᵢ
  double hinge_damping = 0;  ///< ηI [N·m²·s], ≥ 0; hinge i has the moment ηI·θ̇/ℓ̄ᵢ
};

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

/// What an animator asks for. Lengths in metres, y up, SI throughout.
struct Scene {
  std::string name;
  Index particles = 32;      ///< N, 3 … 1 000 000
  double arrival_time = 0;   ///< t₀ [s], > 0; has no default
  double gravity = 9.80665;  ///< downward [m/s²], ≥ 0
  Points initial;            ///< drawn polyline [2 × any], at least 2 distinct points
  Points target;             ///< drawn polyline [2 × any], at least 2 distinct points
  Cloth cloth;
  Launch launch = Launch::ballistic;
  Reference reference = Reference::hold;
  Arrival arrival = Arrival::pass;  ///< used by `morph`
  double damping_ratio = 0;         ///< ζ of the control force, ≥ 0, see shape_control.h
  TargetLength target_length = TargetLength::fit;
  std::optional<double> time_step;  ///< [s], > 0; absent: the engine chooses
  double frames_per_second = 60;    ///< frames kept of a rollout [1/s], > 0
};

/// Throws InputError if a value breaks its rule; `source` names the file in the message.
void validate(const Scene& scene, const std::string& source);

/// Reads and validates a scene from JSON text. A field that is left out has the default above; an
/// unknown one is an error that names the nearest known one.
Scene parse_scene(const std::string& json, const std::string& source);

/// The same from a file. The scene is named after the file unless it names itself.
Scene read_scene(const std::string& path);

/// The scene as JSON text; reading it gives the same scene to the last bit.
std::string to_json(const Scene& scene);

}  // namespace nuno
