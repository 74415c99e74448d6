// MuJoCo: rods in generalised coordinates (two slides and a hinge for the first, a hinge with a
// spring for every other), double precision, semi-implicit Euler (its default).

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <stdexcept>
#include <vector>

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

/// A square sheet as MuJoCo's own composite: particles on three slides each, tendons of fixed
/// length along the edges, elastic ones across. Equal masses; conjugate gradients, as its own
/// examples of cloth take them.
std::string sheet_xml(const Sheet& sheet, Index columns, double h) {
  return fmt::format(
      "<mujoco><size njmax='{}' nconmax='1'/><option timestep='{}' gravity='0 0 {}' solver='CG'>"
      "<flag contact='disable'/></option><worldbody><body><composite type='grid' "
      "count='{} {} 1' spacing='{}'><joint kind='main'/><tendon kind='main'/>"
      "<tendon kind='shear' stiffness='{}'/><geom type='sphere' size='0.001' mass='{}'/>"
      "</composite></body></worldbody></mujoco>",
      10 * sheet.particles(), h, -sheet.gravity, columns, columns, sheet.rest_length[0],
      sheet.material.shear_stiffness, sheet.particle_mass);
}

/// The sheet's vertex that is at this place of the composite's flat grid.
Index vertex_at(const double* flat, Index columns, double spacing) {
  const auto middle = static_cast<double>(columns / 2);  // of its numbering
  const auto column = static_cast<Index>(std::lround(flat[0] / spacing + middle));
  const auto row = static_cast<Index>(std::lround(flat[1] / spacing + middle));
  return row * columns + column;
}

/// x to the right and z up.
Points fly_sheet(const Problem& problem, Index steps, const mjModel* model, mjData* data) {
  const Sheet& sheet = problem.sheet();
  const auto columns = static_cast<Index>(std::lround(std::sqrt(sheet.particles())));
  mj_resetData(model, data);
  mj_kinematics(model, data);
  const auto place = [&](Index body) { return data->xpos + 3 * body; };
  const Index first = model->nbody - sheet.particles();
  std::vector<Index> vertices;  // of the composite's particles
  for (Index body = first; body < model->nbody; ++body) {
    vertices.push_back(vertex_at(place(body), columns, sheet.rest_length[0]));
    const auto x = sheet.initial.col(vertices.back());
    double* slides = data->qpos + model->jnt_qposadr[model->body_jntadr[body]];
    slides[0] = x[0] - place(body)[0];
    slides[1] = x[2] - place(body)[1];
    slides[2] = x[1] - place(body)[2];
  }
  for (Index step = 0; step < steps; ++step) mj_step(model, data);
  mj_kinematics(model, data);
  Points positions(3, sheet.particles());
  for (Index body = first; body < model->nbody; ++body) {
    const double* x = place(body);
    positions.col(vertices[static_cast<std::size_t>(body - first)]) << x[0], x[2], x[1];
  }
  return positions;
}

}  // namespace

std::vector<Peer> mujoco_sheet_peers(const Problem& problem) {
  constexpr Index steps = 400;
  const auto columns = static_cast<Index>(std::lround(std::sqrt(problem.cloth().particles())));
  const double h = problem.arrival_time / static_cast<double>(steps);
  const std::shared_ptr<mjModel> model = compile(sheet_xml(problem.sheet(), columns, h));
  const std::shared_ptr<mjData> data(mj_makeData(model.get()), mj_deleteData);
  return {{fmt::format("MuJoCo {}, composite grid of tendons", mj_versionString()),
           std::numeric_limits<double>::infinity(),
           [&problem, model, data] { return fly_sheet(problem, steps, model.get(), data.get()); },
           steps}};
}

std::vector<Peer> mujoco_peers(const Problem& problem, Index steps) {
  const double h = problem.arrival_time / static_cast<double>(steps);
  const std::shared_ptr<mjModel> model = compile(model_xml(problem.chain(), h));
  const std::shared_ptr<mjData> data(mj_makeData(model.get()), mj_deleteData);
  return {
      {fmt::format("MuJoCo {}, hinges with springs", mj_versionString()), 0.05,
       [&problem, steps, model, data] { return fly(problem, steps, model.get(), data.get()); }}};
}

}  // namespace nuno::bench
