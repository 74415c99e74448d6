// What the studio refuses, and that nothing that a client sends harms it.

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <mutex>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "studio.h"

namespace nuno {
namespace {

TEST_F(Studio, AnswersWhole) {
  for (const char* range : {"0-9", "99999999-", "-1,-2,0-"}) {
    const std::string answer =
        post("/api/simulate", small_scene, std::string("Range: bytes=") + range + "\r\n");
    EXPECT_EQ(status_of(answer), 200) << range;
    EXPECT_TRUE(json_of(answer).is_object()) << range;
  }
}

TEST_F(Studio, ListensOnTheLoopbackAlone) {
  // A socket of /proc/net/tcp: hexadecimal address and port, state 0A listens.
  std::ifstream sockets("/proc/net/tcp");
  std::array<char, 16> port{};
  std::snprintf(port.data(), port.size(), ":%04X ", static_cast<unsigned>(port_));
  int found = 0;
  for (std::string line; std::getline(sockets, line);) {
    if (line.find(port.data()) == std::string::npos || line.find(" 0A ") == std::string::npos) {
      continue;
    }
    ++found;
    EXPECT_NE(line.find("0100007F" + std::string(port.data())), std::string::npos) << line;
  }
  EXPECT_EQ(found, 1);
}

TEST_F(Studio, RefusesOtherNamesAndOtherOrigins) {
  const std::string port = std::to_string(port_);
  const auto with_host = [&](const std::string& lines) {
    return status_of(exchange("GET / HTTP/1.1\r\n" + lines + "\r\n"));
  };
  EXPECT_EQ(with_host("Host: 127.0.0.1:" + port + "\r\n"), 200);
  EXPECT_EQ(with_host("Host: LocalHost:" + port + "\r\n"), 200);
  EXPECT_EQ(with_host(""), 403);
  EXPECT_EQ(with_host("Host: evil.example\r\n"), 403);
  EXPECT_EQ(with_host("Host: 127.0.0.1\r\n"), 403);
  EXPECT_EQ(with_host("Host: 127.0.0.1:" + port + ".evil.example\r\n"), 403);
  EXPECT_EQ(with_host("Host: 127.0.0.1:" + port + "\r\nHost: evil.example\r\n"), 403);

  const auto from = [&](const std::string& origin) {
    return status_of(post("/api/scene", small_scene, "Origin: " + origin + "\r\n"));
  };
  EXPECT_EQ(from("http://127.0.0.1:" + port), 200);
  EXPECT_EQ(from("http://localhost:" + port), 200);
  EXPECT_EQ(from("http://evil.example"), 403);
  EXPECT_EQ(from("https://127.0.0.1:" + port), 403);
  EXPECT_EQ(from("null"), 403);
}

TEST_F(Studio, RefusesWithTheMessagesOfTheCommandLine) {
  const auto refused = [&](const std::string& path, const std::string& body, int status) {
    const std::string answer = post(path, body);
    EXPECT_EQ(status_of(answer), status) << path << ' ' << body;
    return message_of(answer);
  };
  EXPECT_EQ(refused("/api/scene", R"({"nuno_scene":1,"arival_time":1})", 400),
            "scene.json: /arival_time: \"arival_time\" is not a known field; the nearest is "
            "\"arrival_time\"");
  EXPECT_EQ(refused("/api/result?refine=1&alpha=1", small_scene, 400),
            "refine: does not go with alpha, it has a gain of its own");
  EXPECT_TRUE(refused("/api/optimize", "{", 400).starts_with("scene.json: /: not JSON"));
  EXPECT_TRUE(refused("/api/optimize", "", 400).starts_with("scene.json: /: not JSON"));
  EXPECT_EQ(refused("/api/simulate?alpha=-1", small_scene, 400), "alpha: -1 is not >= 0");
  EXPECT_EQ(refused("/api/simulate?alpha=1;frames=2", small_scene, 400),
            "an option of the address has more than one value");
  EXPECT_EQ(refused("/api/simulate?alpha=nan", small_scene, 400),
            "alpha: \"nan\" is not a finite number");
  EXPECT_EQ(refused("/api/optimize?backend=havok", small_scene, 400),
            "backend: \"havok\" is not one of native, box2d, bullet");
  EXPECT_EQ(refused("/api/optimize?backend=bullet", small_scene, 400),
            "scene.json: bullet does not fly a chain; those that do: native, box2d");
  EXPECT_EQ(refused("/api/meshes", R"({"initial":{"name":"a.obj","data":"?"}})", 400),
            "meshes: /initial/data: is not base64");
  EXPECT_EQ(refused("/api/meshes", R"({"initial":{"name":"a.stl","data":"AA=="}})", 400),
            "a.stl: is one mesh; give its second pose as well, or glTF with a morph target");
  EXPECT_EQ(refused("/api/scene",
                    R"({"nuno_scene":1,"arrival_time":1,"initial":"/etc/hosts",)"
                    R"("target":"/etc/hosts"})",
                    400),
            "scene.json: /initial: a mesh file is not read here; give the points of a chain, or "
            "vertices and faces");
  EXPECT_NE(refused("/api/optimize?frames=1e9", small_scene, 400), "");
  EXPECT_NE(refused("/api/optimize?after=1e9&frames=3", small_scene, 400), "");
  EXPECT_NE(refused("/api/optimize?sudo=1", small_scene, 400), "");
  EXPECT_EQ(refused("/api/optimize?refine=yes", small_scene, 400),
            "refine: \"yes\" is not one of 0, 1");
  EXPECT_EQ(refused("/api/optimize?warm_start=-1", small_scene, 400), "warm_start: -1 is not >= 0");
  EXPECT_EQ(refused("/api/optimize?warm_start=1&optimizer=steepest-descent", small_scene, 400),
            "warm_start: is not for the optimizer steepest-descent");
  EXPECT_EQ(refused("/api/scene?foo=1", small_scene, 400),
            "\"foo\": this request takes no options");
  Json fine = Json::parse(small_scene);
  fine["particles"] = 2000;
  fine["cloth"]["hinge_stiffness"] = 0;
  EXPECT_NE(refused("/api/optimize?refine=1", fine.dump(), 400).find("the most to refine"),
            std::string::npos);
  EXPECT_NE(refused("/api/nothing", small_scene, 404), "");
}

TEST_F(Studio, RefusesAFileOfMoreFramesThanAnAnswerHolds) {
  Json scene = Json::parse(small_scene);
  const auto answer = [&](const char* path, const char* field, double value) {
    scene[field] = value;
    return post(path, scene.dump());
  };
  // 8 particles over 0.2 s: 1 250 000 frames a second make 2 million points.
  const double before = memory();
  for (const char* path : {"/api/result", "/api/result?alpha=0.1", "/api/film"}) {
    const std::string refused = answer(path, "frames_per_second", 1'250'001);
    EXPECT_EQ(status_of(refused), 400) << path;
    EXPECT_EQ(message_of(refused),
              "scene.json: /frames_per_second: 1250001 is not <= 1.25e+06, the most that the "
              "studio makes a file of with 8 particles over 0.2 s")
        << path;
  }
  EXPECT_LT(memory(), before + 50e6);
  EXPECT_EQ(status_of(answer("/api/optimize", "frames_per_second", 1'250'001)), 200);
  EXPECT_EQ(status_of(answer("/api/result?alpha=0.1", "frames_per_second", 1000)), 200);
  // Before it is thrown, whose search would take a minute or more.
  Json long_one = Json::parse(long_scene);
  long_one["arrival_time"] = 10.5;
  const auto start = Clock::now();
  EXPECT_NE(message_of(post("/api/film", long_one.dump())).find("/arrival_time: 10.5 is not <= 10"),
            std::string::npos);
  EXPECT_LT(Clock::now() - start, 5s);
}

TEST_F(Studio, RefusesWhatIsNoRequestOfThePage) {
  EXPECT_EQ(status_of(get("/../../etc/passwd")), 404);
  EXPECT_EQ(status_of(get("/api/optimize")), 405);
  EXPECT_EQ(status_of(get(std::string(4000, '/'))), 414);
  EXPECT_EQ(status_of(post("/", small_scene)), 405);
  for (const char* method : {"PUT", "DELETE", "PATCH"}) {
    EXPECT_EQ(status_of(exchange(
                  head(method + std::string(" /api/scene"), "Content-Length: 2\r\n") + "\r\n{}")),
              405)
        << method;
  }
  EXPECT_EQ(status_of(exchange(head("OPTIONS /api/scene") + "\r\n")), 405);
  EXPECT_EQ(status_of(exchange(head("POST /api/scene") + "\r\n")), 411);
  EXPECT_EQ(status_of(exchange(head("POST /api/scene", "Content-Length: 2\r\n") + "\r\n{}")), 415);
  EXPECT_EQ(status_of(exchange("\x01\x02 rubbish\r\n\r\n")), 400);
}

TEST_F(Studio, RefusesALargeBodyAndStaysUsable) {
  const Connection connection(port_);
  connection.send(post_text("/api/scene", std::string(5 << 20, ' ')));
  EXPECT_EQ(status_of(connection.receive()), 413);
  EXPECT_EQ(status_of(post("/api/scene", small_scene)), 200);
}

TEST_F(Studio, AnswersABodyThatNeverComes) {
  EXPECT_EQ(status_of(exchange(head("POST /api/scene",
                                    "Content-Type: application/json\r\nContent-Length: 99\r\n") +
                               "\r\n{")),
            400);
}

// What a careless or hostile program on the machine can send, from a seed.
class HostileClient : public Studio {
 protected:
  static int below(int n, std::mt19937& random) {
    return static_cast<int>(random() % static_cast<unsigned>(n));
  }

  static std::string some_rubbish(int most, bool printable, std::mt19937& random) {
    std::string text(static_cast<std::size_t>(below(most, random)), ' ');
    for (char& c : text) {
      c = static_cast<char>(printable ? 33 + below(94, random) : below(256, random));
      if (c == '\n' || c == '\r') c = '.';
    }
    return text;
  }

  /// `leaves`: to hang up in the middle of the body.
  std::string random_request(std::mt19937& random, bool& leaves) const {
    const auto below = [&](int n) { return HostileClient::below(n, random); };
    const auto rubbish = [&](int most, bool printable) {
      return some_rubbish(most, printable, random);
    };
    static const std::array paths = {"/api/optimize",
                                     "/api/simulate",
                                     "/api/result",
                                     "/api/scene",
                                     "/api/optimize?backend=native&frames=3",
                                     "/api/optimize?warm_start=0.1&refine=1",
                                     "/api/pareto_front",
                                     "/api/progress?page=a",
                                     "/api/about",
                                     "/"};
    const std::string path = paths[static_cast<std::size_t>(below(static_cast<int>(paths.size())))];
    std::string scene = small_scene;
    leaves = false;
    switch (below(12)) {
      case 0:
        return rubbish(200, false).append("\r\n\r\n");
      case 1:
        return head("GET /" + rubbish(300, true)) + "\r\n";
      case 2:
        return head(rubbish(9, true) + "X " + path) + "\r\n";
      case 3:
        for (int i = 1 + below(4); i > 0; --i) {
          scene[static_cast<std::size_t>(below(static_cast<int>(scene.size())))] =
              static_cast<char>(below(256));
        }
        return post_text("/api/scene", scene);
      case 4:
        return post_text(path, scene.substr(0, static_cast<std::size_t>(below(100))));
      case 5:
        return post_text(path, std::string(static_cast<std::size_t>(below(20000)), '['));
      case 6:
        return post_text(path + std::string(1, '?') + rubbish(200, true), scene);
      case 7:
        return "POST " + path + " HTTP/1.1\r\nHost: " + rubbish(40, true) +
               "\r\nContent-Type: application/json\r\nContent-Length: 2\r\n\r\n{}";
      case 8:
        return post_text(path, scene, "Origin: " + rubbish(40, true) + "\r\n");
      case 9:
        leaves = true;  // in the middle of its body
        return head("POST " + path,
                    "Content-Type: application/json\r\nContent-Length: 100000\r\n") +
               "\r\n" + scene;
      case 10:
        return head("GET " + path, "Range: bytes=" + rubbish(100, true) +
                                       "\r\nX: " + rubbish(4000, true) + "\r\n") +
               "\r\n";
      default:
        return post_text(path, scene, "Content-Encoding: gzip\r\n");
    }
  }
};

TEST_F(HostileClient, GetsAnAnswerToEveryRequestAndTheStudioKeepsItsMemory) {
  constexpr int requests = 10'000, clients = 8, warm_up = 2'000;
  std::atomic<int> next = 0, unanswered = 0, failed = 0;
  std::string first_unanswered;
  std::mutex mutex;
  double warm_memory = 0;
  const auto start = Clock::now();
  const auto run = [&](int until) {
    std::vector<std::jthread> threads;
    for (int t = 0; t < clients; ++t) {
      threads.emplace_back([&] {
        for (int i; (i = next++) < until;) {
          std::mt19937 random(static_cast<unsigned>(i));
          bool leaves = false;
          const std::string text = random_request(random, leaves);
          const Connection connection(port_);
          connection.send(text);
          if (leaves) continue;
          const int status = status_of(connection.receive(20s));
          failed += status >= 500;
          if (status != 0) continue;
          ++unanswered;
          const std::scoped_lock lock(mutex);
          if (first_unanswered.empty()) first_unanswered = text.substr(0, 300);
        }
      });
    }
    threads.clear();  // joins
    next = until;
  };
  run(warm_up);
  warm_memory = memory();
  run(requests);
  const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
  std::printf("%d requests in %.1f s; memory %.1f MB after %d, %.1f MB after all\n", requests,
              seconds, warm_memory / 1e6, warm_up, memory() / 1e6);
  EXPECT_EQ(unanswered, 0) << first_unanswered;
  EXPECT_EQ(failed, 0);
  // The allocator's own pools may still grow a little; a leak of 1 kB a request is more.
  EXPECT_LT(memory(), warm_memory + 8e6);
  EXPECT_EQ(status_of(post("/api/optimize", small_scene)), 200);
}

}  // namespace
}  // namespace nuno
