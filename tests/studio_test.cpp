// What the studio answers, and how it begins and ends.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <csignal>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "studio.h"

namespace nuno {
namespace {

TEST_F(Studio, ServesThePageAndItsParts) {
  const std::string page = get("/");
  EXPECT_EQ(status_of(page), 200);
  EXPECT_NE(page.find("Content-Security-Policy: default-src 'self'"), std::string::npos);
  // Every module that the page asks for, from the first one on.
  std::vector<std::string> parts = {"/studio.css", "/studio.js", "/api/about"};
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const std::string part = get(parts[i]);
    EXPECT_EQ(status_of(part), 200) << parts[i];
    const std::string import = "from '.";
    for (std::size_t at = part.find(import); at != part.npos; at = part.find(import, at)) {
      at += import.size();
      const std::string found = part.substr(at, part.find('\'', at) - at);
      if (std::ranges::find(parts, found) == parts.end()) parts.push_back(found);
    }
  }
  EXPECT_GT(parts.size(), 10u);
}

TEST_F(Studio, PacksNothing) {
  const std::string answer =
      post("/api/optimize?frames=4", small_scene, "Accept-Encoding: gzip, deflate, br\r\n");
  EXPECT_EQ(status_of(answer), 200);
  EXPECT_EQ(answer.find("Content-Encoding"), std::string::npos);
  EXPECT_TRUE(json_of(answer).is_object());
}

TEST_F(Studio, AnswersAsTheCommandLineToTheLastBit) {
  const std::string path = scene("letter-z");
  const Json expected = simulated({"optimize", path});

  for (const char* request : {"/api/optimize?page=a", "/api/optimize?frames=12", "/api/result"}) {
    const Json answer = json_of(post(request, read_text(path)));
    ASSERT_TRUE(answer.is_object()) << request;
    for (const char* field : {"alpha", "error", "control_effort", "steps", "target_scale"}) {
      EXPECT_EQ(answer[field], expected[field]) << request << ' ' << field;
    }
  }
}

TEST_F(Studio, JudgesAFlightAsTheCommandLineDoes) {
  Json coarse = read_json(scene("hanging-to-arch-32"));
  coarse["cloth"]["stretch_stiffness"] = 2e5;
  coarse["cloth"]["hinge_stiffness"] = 1e-5;
  const std::string path = in_folder("coarse.json");
  write_text(path, coarse.dump());
  const Json expected = simulated({"simulate", path});
  ASSERT_TRUE(expected.contains("step_error"));
  for (const char* request :
       {"/api/simulate?judge=1", "/api/simulate?frames=9&after=1&judge=1", "/api/result?alpha=0"}) {
    const Json answer = json_of(post(request, coarse.dump()));
    ASSERT_TRUE(answer.contains("step_error")) << request;
    for (const char* field : {"sensitivity", "step_error", "finer_strain", "steps"}) {
      EXPECT_EQ(answer[field], expected[field]) << request << ' ' << field;
    }
  }
  const auto remarks = [&](const std::string& request, const std::string& of) {
    return json_of(post(request, of))["remarks"].get<std::string>();
  };
  EXPECT_NE(remarks("/api/simulate?judge=1", coarse.dump()).find("Coarse: half of the step moves"),
            std::string::npos);
  EXPECT_EQ(remarks("/api/simulate", coarse.dump()).find("Coarse"), std::string::npos);
  EXPECT_NE(
      remarks("/api/optimize?judge=1", read_text(scene("letter-z"))).find("Fragile: a change"),
      std::string::npos);
}

TEST_F(Studio, AWarmStartFollowsTheBestGain) {
  const std::string scene = read_text(nuno::scene("letter-z"));
  const Json best = json_of(post("/api/optimize", scene));
  const std::string start = std::to_string(1.1 * best["alpha"].get<double>());
  const Json warm = json_of(post("/api/optimize?warm_start=" + start, scene));
  // What the search guarantees: a thousandth of the error, and the valley is that of the best.
  EXPECT_NEAR(warm["error"]["mean"].get<double>(), best["error"]["mean"].get<double>(),
              2e-3 * best["error"]["mean"].get<double>());
  EXPECT_LT(warm["optimization"]["evaluations"], best["optimization"]["evaluations"]);
}

TEST_F(Studio, RefinesAsTheCommandLineDoes) {
  Json scene = Json::parse(small_scene);
  scene["reference"] = "morph";
  scene["damping_ratio"] = 0.7;
  write_text(in_folder("scene.json"), scene.dump());
  const Json expected = simulated({"optimize", in_folder("scene.json"), "--refine"});

  const Json plain = json_of(post("/api/optimize", scene.dump()));
  const Json corrected = json_of(post("/api/optimize?refine=1", scene.dump()));
  EXPECT_EQ(corrected["error"], expected["error"]);
  EXPECT_EQ(corrected["optimization"]["alpha"], plain["alpha"]);
  EXPECT_LT(corrected["error"]["mean"], plain["error"]["mean"]);
  const Json result = json_of(post("/api/result?refine=1", scene.dump()));
  EXPECT_EQ(result["final"], expected["final"]);
  EXPECT_EQ(result["reference_correction"].size(), 4u);
  EXPECT_EQ(result["reference_correction"], expected["reference_correction"]);
}

TEST_F(Studio, TradesErrorForEffort) {
  const Json answer = json_of(post("/api/pareto_front", small_scene));
  const Json& curve = answer["pareto_front"];
  ASSERT_GT(curve.size(), 2u);
  EXPECT_EQ(curve[0]["alpha"], 0);
  EXPECT_EQ(curve[0]["control_effort"], 0);
  for (std::size_t i = 1; i < curve.size(); ++i) {
    EXPECT_GT(curve[i]["control_effort"], curve[i - 1]["control_effort"]);
    EXPECT_LT(curve[i]["error"], curve[i - 1]["error"]);
  }
  const Json& last = curve.back();
  const Json there = json_of(post("/api/simulate?alpha=" + last["alpha"].dump(), small_scene));
  EXPECT_EQ(there["error"]["mean"], last["error"]);
  EXPECT_EQ(there["control_effort"], last["control_effort"]);
}

TEST_F(Studio, SaysHowMuchOfAFilmIsMade) {
  EXPECT_EQ(json_of(get("/api/progress?page=a")), (Json{{"progress", 0}}));
  EXPECT_EQ(status_of(get("/api/progress?film=a")), 400);
  EXPECT_EQ(status_of(post("/api/progress?page=a", small_scene)), 405);
}

TEST_F(Studio, FramesReachArrivalAndFlyOn) {
  const Json answer = json_of(post("/api/simulate?alpha=0.5&frames=20&after=0.1", small_scene));
  const auto times = answer["frames"]["times"].get<std::vector<double>>();
  ASSERT_EQ(times.size(), 31u);  // 20 intervals until arrival, half as many after
  EXPECT_DOUBLE_EQ(times[20], 0.2);
  const Json& positions = answer["frames"]["positions"];
  EXPECT_EQ(positions[20], answer["final"]);
  EXPECT_EQ(answer["frames"]["forces"][21], Json(std::vector(8, std::array{0, 0})));
}

// What is drawn is the very flight whose error is told, a sheet's damping included.
TEST_F(Studio, ASheetsFramesEndWhereItArrives) {
  Json sheet = Json::parse(
      R"({"nuno_scene":1,"arrival_time":0.4,"reference":"morph","damping_ratio":0.7,
          "initial":{"vertices":[[0,0,0],[1,0,0],[0,0,1],[1,0,1]],"faces":[[0,2,1],[1,2,3]]},
          "target":{"vertices":[[2,1,0],[3,1,0],[2,1,1],[2.9,1.4,1]]}})");
  const Json answer = json_of(post("/api/simulate?alpha=0.5&frames=8&after=0.1", sheet.dump()));
  ASSERT_TRUE(answer.contains("frames")) << answer.dump();
  const Json& frames = answer["frames"];
  EXPECT_EQ(frames["positions"][8], answer["final"]);
  EXPECT_EQ(frames["times"].size(), 11u);
  EXPECT_EQ(answer["crossings"]["frames"], 9);
}

TEST_F(Studio, AnswersManyAtOnce) {
  std::atomic<int> right = 0;
  {
    std::vector<std::jthread> clients;
    for (int i = 0; i < 16; ++i) {
      clients.emplace_back([&, i] {
        const std::string page = std::to_string(i);
        for (int n = 0; n < 5; ++n) {
          right += status_of(post("/api/optimize?frames=4&page=" + page, small_scene)) == 200;
        }
      });
    }
  }
  EXPECT_EQ(right, 16 * 5);
}

TEST_F(Studio, ANewerRequestOfAPageEndsTheOlder) {
  for (const char* path : {"/api/optimize?page=a&backend=box2d",
                           "/api/pareto_front?page=a&backend=box2d", "/api/report?page=a"}) {
    const Connection older(port_);
    older.send(post_text(path, long_scene));
    std::this_thread::sleep_for(300ms);
    const auto start = Clock::now();
    EXPECT_EQ(status_of(post("/api/optimize?page=a", small_scene)), 200);
    const std::string answer = older.receive();
    EXPECT_EQ(status_of(answer), 409) << path << ' ' << body_of(answer).substr(0, 200);
    // A portion of the search, on a machine that has other work; the whole takes minutes.
    EXPECT_LT(Clock::now() - start, 30s);
  }
}

TEST_F(Studio, ControlCEndsItAtOnce) {
  const Connection busy(port_);
  busy.send(post_text("/api/optimize?backend=box2d", long_scene));
  std::this_thread::sleep_for(200ms);
  const auto start = Clock::now();
  ::kill(process_, SIGINT);
  int status = 0;
  ::waitpid(process_, &status, 0);
  process_ = 0;
  EXPECT_LT(Clock::now() - start, 1s);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
}

TEST_F(Studio, ControlCLeavesNothingOfAFilm) {
  if (!is_installed("ffmpeg")) GTEST_SKIP() << "ffmpeg is not installed";
  Json scene = Json::parse(small_scene);
  scene["arrival_time"] = 3;      // 180 pictures: seconds
  const auto named_files = [&] {  // that the studio holds open
    std::set<fs::path> files;
    for (const auto& open : fs::directory_iterator("/proc/" + std::to_string(process_) + "/fd")) {
      std::error_code gone;
      const fs::path file = fs::read_symlink(open, gone);
      if (fs::is_regular_file(file, gone)) files.insert(file);
    }
    return files;
  };
  const std::set<fs::path> before = named_files();
  const Connection busy(port_);
  busy.send(post_text("/api/film?alpha=0.1&page=a", scene.dump()));
  const auto patience = Clock::now() + 60s;
  while (json_of(get("/api/progress?page=a")).value("progress", 0.0) == 0) {
    ASSERT_LT(Clock::now(), patience);
    std::this_thread::sleep_for(1ms);
  }
  EXPECT_EQ(named_files(), before);
  const auto start = Clock::now();
  ::kill(process_, SIGINT);
  ::waitpid(process_, nullptr, 0);
  process_ = 0;
  EXPECT_LT(Clock::now() - start, 1s);
}

class SecondStudio : public Studio {
 protected:
  void TearDown() override {
    Studio::TearDown();
    ::kill(first_, SIGTERM);
    ::waitpid(first_, nullptr, 0);
  }
  pid_t first_ = 0;
};

TEST_F(SecondStudio, TakesAFreePortWhereTheWishedOneIsTaken) {
  first_ = process_;
  const int taken = port_;
  port_ = 0;
  said_.clear();
  start(std::to_string(taken));
  EXPECT_NE(port_, taken);
  EXPECT_NE(said_.find("port " + std::to_string(taken) + " is taken"), std::string::npos);
  EXPECT_EQ(status_of(get("/api/about")), 200);
}

}  // namespace
}  // namespace nuno
