// MuJoCo: rods in generalised coordinates (two slides and a hinge for the first, a hinge with a
// spring for every other), double precision, semi-implicit Euler (its default).

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <cmath>
#include <cstring>
#include <memory>
#include <stdexcept>

#include "peers.h"

namespace nuno::bench {
namespace {

/// x is right, z is up; a positive angle turns x towards z.
std::string model_xml(const Chain& chain, double h) {
  std::string xml = fmt::format(
      "<mujoco><compiler angle='radian'/><option timestep='{}' gravity='0 0 {}'>"
      "<flag contact='disable'/></option><worldbody>",
      h, -chain.gravity);
  const std::vector<Rod> rod = rods(chain);
  for (std::size_t i = 0; i < rod.size(); ++i) {
    xml += fmt::format("<body pos='{} 0 0'>", i == 0 ? 0 : rod[i - 1].length);
    if (i == 0) {
      xml +=
          "<joint type='slide' axis='1 0 0'/><joint type='slide' axis='0 0 1'/>"
          "<joint type='hinge' axis='0 -1 0'/>";
    } else {
      const auto hinge = static_cast<Index>(i - 1);
      xml += fmt::format("<joint type='hinge' axis='0 -1 0' stiffness='{}'/>",
                         chain.material.hinge_stiffness / chain.hinge_length[hinge]);
    }
    // MuJoCo wants some inertia about the rod's own axis, about which nothing turns.
    xml += fmt::format("<inertial pos='{} 0 0' mass='{}' diaginertia='{} {} {}'/>", rod[i].center,
                       rod[i].mass, 0.01 * rod[i].inertia, rod[i].inertia, rod[i].inertia);
  }
  for (std::size_t i = 0; i < rod.size(); ++i) xml += "</body>";
  return xml + "</worldbody></mujoco>";
}

std::shared_ptr<mjModel> compile(const std::string& xml) {
  const auto files = std::make_unique<mjVFS>();
  mj_defaultVFS(files.get());
  mj_makeEmptyFileVFS(files.get(), "chain.xml", static_cast<int>(xml.size()));
  std::memcpy(files->filedata[0], xml.data(), xml.size());
  char message[1000] = "";
  mjModel* model = mj_loadXML("chain.xml", files.get(), message, sizeof message);
  mj_deleteVFS(files.get());
  if (model == nullptr) throw std::runtime_error(fmt::format("MuJoCo: {}", message));
  return {model, mj_deleteModel};
}

Points fly(const Problem& problem, Index steps, const mjModel* model, mjData* data) {
  const Chain& chain = problem.chain();
  mj_resetData(model, data);
  data->qpos[0] = chain.initial(0, 0);
  data->qpos[1] = chain.initial(1, 0);
  double before = 0;
  for (Index i = 0; i < chain.rest_length.size(); ++i) {
    const Vector span = chain.initial.col(i + 1) - chain.initial.col(i);
    const double angle = std::atan2(span[1], span[0]);
    data->qpos[2 + i] = std::remainder(angle - before, 2 * mjPI);
    before = angle;
  }
  for (Index step = 0; step < steps; ++step) mj_step(model, data);

  Points positions(2, chain.particles());
  positions.col(0) << data->qpos[0], data->qpos[1];
  double angle = 0;
  for (Index i = 0; i < chain.rest_length.size(); ++i) {
    angle += data->qpos[2 + i];
    positions.col(i + 1) =
        positions.col(i) + chain.rest_length[i] * Eigen::Vector2d(std::cos(angle), std::sin(angle));
  }
  return positions;
}

}  // namespace

std::vector<Peer> mujoco_peers(const Problem& problem, Index steps) {
  const double h = problem.arrival_time / static_cast<double>(steps);
  const std::shared_ptr<mjModel> model = compile(model_xml(problem.chain(), h));
  const std::shared_ptr<mjData> data(mj_makeData(model.get()), mj_deleteData);
  return {
      {fmt::format("MuJoCo {}, hinges with springs", mj_versionString()), 0.05,
       [&problem, steps, model, data] { return fly(problem, steps, model.get(), data.get()); }}};
}

}  // namespace nuno::bench
