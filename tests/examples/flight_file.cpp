#include <nuno/flight_file.h>

#include <gtest/gtest.h>

#include "../temporary_folder.h"
#include "arch.h"

namespace nuno {

TEST(Example, AFlightIsWrittenAsItsFileIsCalled) {
  const TemporaryFolder folder;
  const std::string out = (folder / "arch.glb").string();
  const SceneFile file = make_scene_file("arch", arch());
  const auto backend = make_backend("native", file);
  require_room(file, out, {});
  const Rollout flight = rollout(*backend, 0, {.frames_per_second = 24});
  write_flight(out, file, *backend, flight, sensitivity(*backend, flight), {}, std::nullopt);
  EXPECT_TRUE(std::filesystem::exists(out));
}

}  // namespace nuno
