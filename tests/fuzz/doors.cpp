#include <utility>  // Asio forgets it

#include "fuzz/doors.h"

#include <nuno/engines.h>
#include <nuno/glb_file.h>
#include <nuno/native.h>
#include <nuno/output.h>
#include <nuno/rollout.h>
#include <nuno/scene_file.h>

#include <boost/asio/buffer.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/string_body.hpp>

#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <mutex>
#include <nlohmann/json.hpp>
#include <stop_token>
#include <thread>
#include <variant>

#include "pictures/drawn_result.h"
#include "pictures/flight_figure.h"
#include "studio/connection.h"
#include "studio/site.h"

namespace nuno::fuzz {
namespace {

constexpr double little_work = 2e4;  // particle-steps
constexpr int port = 8471;

void require(bool right, const char* what, const std::string& about) {
  if (right) return;
  std::fprintf(stderr, "%s: %s\n", what, about.substr(0, 2000).c_str());
  std::abort();
}

void require_text(const std::string& text) {
  require(printable(text) == text, "not one line of UTF-8", text);
}

std::string read_text(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

/// A folder with the meshes that the sheet scenes of the seeds name.
const std::string& folder() {
  static const std::string path = NUNO_SCENES "/sheets";
  return path;
}

void fly(const SceneFile& file) {
  for (const std::string_view engine : engines_for(file.problem)) {
    const auto backend = make_backend(engine, file);
    const auto particles = static_cast<double>(file.problem.cloth().particles());
    if (static_cast<double>(backend->steps()) * particles > little_work) continue;
    const Rollout flight = rollout(*backend, 0.1 * objective(*backend).gain_scale);
    if (flight.status == RolloutStatus::diverged) {
      require_text(flight.reason);
      continue;
    }
    require(flight.final.allFinite(), "a flight that is ok is not finite", file.path);
  }
}

bool enter_scene(const std::string& input, bool sheet) {
  AnyScene scene = sheet ? parse_any_scene(input, folder() + "/scene.json")
                         : AnyScene(parse_scene(input, "scene.json"));
  if (auto* chain = std::get_if<ChainScene>(&scene)) {
    const std::string written = to_json(*chain);
    require(to_json(parse_scene(written, "written.json")) == written, "not read as written",
            written);
    if (chain->particles > 10'000) return true;  // resampling them takes its time
  }
  fly(make_scene_file("scene.json", std::move(scene)));
  return true;
}

bool enter_mesh(const std::string& input) {
  Mesh mesh = parse_obj(input, "mesh.obj");
  require_same_faces(mesh, "mesh.obj", mesh, "mesh.obj");
  cut_polygons(mesh);
  SheetScene scene;
  scene.arrival_time = 0.1;
  scene.initial = scene.target = mesh.vertices;
  scene.faces = mesh.faces;
  validate(scene, "mesh.obj");
  const SceneFile file = make_scene_file("mesh.obj", SheetInput{scene, mesh});
  fly(file);
  return true;
}

bool enter_result(const std::string& input) {
  if (is_scene(input, "result.json")) return false;
  const std::vector flights = {parse_result(input, "result.json")};
  if (flights[0].positions.size() * static_cast<std::size_t>(flights[0].target.cols()) > 2000) {
    return true;
  }
  const auto figure = figures::captioned(flights, false);
  for (const std::string& svg : {figures::draw_flights(flights, figure).svg(),
                                 figures::draw_motion(flights, 1, figure).svg()}) {
    std::string lines = svg;
    for (char& c : lines) c = c == '\n' ? ' ' : c;
    require_text(lines);
    require(svg.find("nan") == svg.npos && svg.find("\"inf") == svg.npos, "NaN in a drawing", svg);
  }
  return true;
}

void require_answer(const studio::Answer& answer) {
  require(answer.status >= 200 && answer.status < 600, "no status", answer.body);
  require(answer.status != 500, "the studio failed", answer.body);
  if (answer.type == "application/json") {
    require(nlohmann::json::accept(answer.body), "an answer is no JSON", answer.body);
    require(!answer.body.starts_with(R"({"error":"--)"), "speaks of an option", answer.body);
  }
}

/// The answer to work that is ended after a while, as by a client that leaves.
studio::Answer done_in_time(const studio::Work& work, std::chrono::milliseconds patience) {
  std::mutex mutex;
  std::condition_variable_any ended;
  const std::jthread leaves([&](std::stop_token stop) {
    std::unique_lock lock(mutex);
    ended.wait_for(lock, stop, patience, [] { return false; });
    work.turn.end();
  });
  return work.run();
}

bool enter_page(const std::string& input, std::chrono::milliseconds patience) {
  namespace http = boost::beast::http;
  static studio::Site site(port);
  http::request_parser<http::string_body> parser;
  parser.header_limit(studio::largest_head);
  parser.body_limit(studio::largest_body);
  parser.eager(true);
  boost::system::error_code error;
  parser.put(boost::asio::buffer(input), error);
  if (!parser.is_header_done()) return false;
  const studio::Head head = studio::head_of(parser.get().base());
  if (const auto refusal = site.refused(head)) {
    require_answer(*refusal);
    return false;
  }
  if (head.method != "POST") {
    require_answer(site.get(head));
    return true;
  }
  if (error || !parser.is_done()) return false;
  const auto asked = site.post(head, parser.get().body());
  const auto* const work = std::get_if<studio::Work>(&asked);
  const studio::Answer answer =
      work ? done_in_time(*work, patience) : std::get<studio::Answer>(asked);
  require_answer(answer);
  return answer.status == 200;
}

std::string request(const std::string& line, const std::string& fields, const std::string& body) {
  return line + " HTTP/1.1\r\nHost: 127.0.0.1:8471\r\n" + fields +
         (body.empty() ? "" : "Content-Length: " + std::to_string(body.size()) + "\r\n") + "\r\n" +
         body;
}

const char* const chain =
    R"({"nuno_scene":1,"name":"a","particles":8,"arrival_time":0.2,"gravity":9.8,)"
    R"("initial":[[0,0],[1,0]],"target":[[1,0],[1.5,0.5],[1,1]],"cloth":{"mass":0.1,)"
    R"("air_drag":0.05,"stretch_stiffness":200,"hinge_stiffness":1e-3,"hinge_damping":0},)"
    R"("launch":"ballistic","reference":"morph","arrival":"settle","damping_ratio":0.7,)"
    R"("target_length":"fit","time_step":0.001,"frames_per_second":60})";

const char* const sheet =
    R"({"nuno_scene":1,"arrival_time":0.05,"initial":"square-to-s-start.obj",)"
    R"("target":"square-to-s-target.obj","material":"cotton","rest":"flat",)"
    R"("cloth":{"areal_density":0.15,"bending_stiffness":1e-4},"time_step":0.001})";

const char* const result =
    R"({"nuno_result":1,"scene":"ü","backend":"native","status":"ok","alpha":0.1,)"
    R"("cloth_length":1,"error":{"mean":0.01,"max":0.02},"launch_velocity":[[1,2],[1,2],[1,2]],)"
    R"("target":[[2,1],[2.5,1.3],[3,1]],"final":[[2,1],[2.5,1.2],[3,1]],"frames":{"times":)"
    R"([0,0.5],"positions":[[[0,1],[0.5,1],[1,1]],[[2,1],[2.5,1.2],[3,1]]]}})";

}  // namespace

std::vector<std::string> seeds(Door door) {
  switch (door) {
    case Door::scene:
      return {chain, read_text(NUNO_SCENES "/s-curve-32.json")};
    case Door::sheet_scene:
      return {sheet, read_text(folder() + "/square-to-s.json")};
    case Door::mesh:
      return {"v 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 0 1\nvt 0 0\nvt 1 1\nf 1/1 2/2 3/2 4/1\n",
              "# a\no b\nv 0 0 0\nv 1 0 0 1\nv 1 0.5 1\nv 0 0 1\nv 0.5 0 2\nvn 0 1 0\n"
              "f 1//1 2//1 3//1\nf -3 -2 \\\n -5\nf 4 3 5\n"};
    case Door::result:
      return {result};
    case Door::page_request:
      break;
  }
  const std::string json = "Content-Type: application/json\r\n";
  return {request("POST /api/optimize?page=a&frames=3&after=0.1", json, chain),
          request("POST /api/simulate?alpha=0.1&backend=box2d", json, chain),
          request("POST /api/optimize?warm_start=0.1&refine=1", json, chain),
          request("POST /api/result?optimizer=steepest-descent", json, chain),
          request("POST /api/pareto_front", json + "Origin: http://localhost:8471\r\n", chain),
          request("POST /api/scene", json, chain),
          request("GET http://127.0.0.1:8471/api/progress?page=%41", "", ""),
          request("POST /api/scene", json + "Transfer-Encoding: chunked\r\n", "") +
              "4\r\n{\"a\"\r\n0\r\nX: y\r\n\r\n"};
}

bool enter(Door door, const std::string& input, std::chrono::milliseconds patience) {
  try {
    switch (door) {
      case Door::scene:
        return enter_scene(input, false);
      case Door::sheet_scene:
        return enter_scene(input, true);
      case Door::mesh:
        return enter_mesh(input);
      case Door::result:
        return enter_result(input);
      case Door::page_request:
        return enter_page(input, patience);
    }
  } catch (const InputError& error) {
    // As people see it: a name may hold any byte. Cut where it stands, not just before it is told.
    const std::string said = message_for_people(error.what());
    require_text(said);
    require(said == printable(error.what()), "a long message", error.what());
  }
  return false;
}

}  // namespace nuno::fuzz
