// `nuno studio` as a client sees it that need not be a browser and need not be friendly.

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <mutex>
#include <optional>
#include <random>
#include <string>
#include <thread>
#include <vector>

namespace nuno {
namespace {

using Json = nlohmann::json;
using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

std::string text_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

// A small scene: a throw of it takes a fraction of a millisecond.
const std::string small_scene =
    R"({"nuno_scene":1,"particles":8,"arrival_time":0.2,"initial":[[0,0],[1,0]],)"
    R"("target":[[1,0],[1,1]]})";

// One whose search takes a minute or more.
const std::string long_scene =
    R"({"nuno_scene":1,"particles":64,"arrival_time":2,"initial":[[0,0],[1,0]],)"
    R"("target":[[1,0],[1,1]]})";

class Connection {
 public:
  explicit Connection(int port) : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const void* const raw = &address;
    connected_ = ::connect(socket_, static_cast<const sockaddr*>(raw), sizeof address) == 0;
  }
  ~Connection() { ::close(socket_); }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  bool connected() const { return connected_; }

  void send(const std::string& text) const {
    for (std::size_t sent = 0; sent < text.size();) {
      const ssize_t n = ::send(socket_, text.data() + sent, text.size() - sent, MSG_NOSIGNAL);
      if (n <= 0) return;  // the server has heard enough
      sent += static_cast<std::size_t>(n);
    }
  }

  /// The answer with its whole body; what there is of it after `patience` or at the end.
  std::string receive(std::chrono::milliseconds patience = 60s) const {
    const auto until = Clock::now() + patience;
    std::string text;
    std::optional<std::size_t> whole;
    while (!whole || text.size() < *whole) {
      const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(until - Clock::now());
      pollfd waiting{socket_, POLLIN, 0};
      if (left.count() <= 0 || ::poll(&waiting, 1, static_cast<int>(left.count())) <= 0) break;
      std::array<char, 65536> buffer;
      const ssize_t n = ::recv(socket_, buffer.data(), buffer.size(), 0);
      if (n <= 0) break;
      text.append(buffer.data(), static_cast<std::size_t>(n));
      const std::size_t end = text.find("\r\n\r\n");
      if (!whole && end != std::string::npos) {
        const std::size_t length = text.find("Content-Length: ");
        whole =
            end + 4 + (length < end ? std::strtoul(text.c_str() + length + 16, nullptr, 10) : 0);
      }
    }
    return text;
  }

 private:
  int socket_;
  bool connected_ = false;
};

int status_of(const std::string& answer) {
  return answer.starts_with("HTTP/1.") ? std::atoi(answer.c_str() + 9) : 0;
}

std::string body_of(const std::string& answer) {
  const std::size_t end = answer.find("\r\n\r\n");
  return end == std::string::npos ? "" : answer.substr(end + 4);
}

Json json_of(const std::string& answer) { return Json::parse(body_of(answer), nullptr, false); }

std::string message_of(const std::string& answer) { return json_of(answer).value("error", ""); }

class Studio : public testing::Test {
 protected:
  void SetUp() override { start("0"); }

  void start(const std::string& wished_port) {
    std::array<int, 2> pipe{};
    ASSERT_EQ(::pipe2(pipe.data(), O_CLOEXEC), 0);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, pipe[1], STDOUT_FILENO);
    std::vector<std::string> words = {NUNO_PROGRAM, "studio", "--no-open", "--port", wished_port};
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    ASSERT_EQ(posix_spawn(&process_, NUNO_PROGRAM, &actions, nullptr, arguments.data(), environ),
              0);
    posix_spawn_file_actions_destroy(&actions);
    ::close(pipe[1]);
    const std::string mark = "http://127.0.0.1:";
    char c = 0;
    while (::read(pipe[0], &c, 1) == 1) {
      said_ += c;
      const std::size_t at = said_.find(mark);
      if (at != std::string::npos && said_.back() == '\n') {
        port_ = std::atoi(said_.c_str() + at + mark.size());
        break;
      }
    }
    ::close(pipe[0]);
    ASSERT_GT(port_, 0) << said_;
  }

  void TearDown() override {
    if (process_ > 0) {
      ::kill(process_, SIGTERM);
      ::waitpid(process_, nullptr, 0);
    }
  }

  std::string head(const std::string& first_line, const std::string& more = "") const {
    return first_line + " HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(port_) + "\r\n" + more;
  }
  std::string post_text(const std::string& path, const std::string& body,
                        const std::string& more = "") const {
    return head("POST " + path, "Content-Type: application/json\r\nContent-Length: " +
                                    std::to_string(body.size()) + "\r\n" + more) +
           "\r\n" + body;
  }
  std::string exchange(const std::string& text) const {
    const Connection connection(port_);
    connection.send(text);
    return connection.receive();
  }
  std::string get(const std::string& path, const std::string& more = "") const {
    return exchange(head("GET " + path, more) + "\r\n");
  }
  std::string post(const std::string& path, const std::string& body,
                   const std::string& more = "") const {
    return exchange(post_text(path, body, more));
  }

  /// Resident memory of the server [bytes].
  double memory() const {
    std::ifstream status("/proc/" + std::to_string(process_) + "/status");
    for (std::string line; std::getline(status, line);) {
      if (line.starts_with("VmRSS:")) return 1024 * std::strtod(line.c_str() + 6, nullptr);
    }
    return 0;
  }

  pid_t process_ = 0;
  int port_ = 0;
  std::string said_;
};

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

TEST_F(Studio, AnswersAsTheCommandLineToTheLastBit) {
  const std::string path = NUNO_SCENES "/letter-z.json";
  const auto out = std::filesystem::path(testing::TempDir()) /
                   ("studio-" + std::to_string(::getpid()) + ".json");
  const std::string command = std::string(NUNO_PROGRAM) + " optimize " + path + " --out " +
                              out.string() + " > /dev/null 2>&1";
  ASSERT_EQ(std::system(command.c_str()), 0);
  const Json expected = Json::parse(text_of(out.string()));
  std::filesystem::remove(out);

  for (const char* request : {"/api/optimize?page=a", "/api/optimize?frames=12", "/api/result"}) {
    const Json answer = json_of(post(request, text_of(path)));
    ASSERT_TRUE(answer.is_object()) << request;
    for (const char* field : {"alpha", "error", "control_effort", "steps", "target_scale"}) {
      EXPECT_EQ(answer[field], expected[field]) << request << ' ' << field;
    }
  }
}

TEST_F(Studio, AWarmStartFollowsTheBestGain) {
  const std::string scene = text_of(NUNO_SCENES "/letter-z.json");
  const Json best = json_of(post("/api/optimize", scene));
  const std::string start = std::to_string(1.1 * best["alpha"].get<double>());
  const Json warm = json_of(post("/api/optimize?warm_start=" + start, scene));
  // What the search promises: a thousandth of the error, and the valley is that of the best.
  EXPECT_NEAR(warm["error"]["mean"].get<double>(), best["error"]["mean"].get<double>(),
              2e-3 * best["error"]["mean"].get<double>());
  EXPECT_LT(warm["optimization"]["evaluations"], best["optimization"]["evaluations"]);
}

TEST_F(Studio, AimsOffAsTheCommandLineDoes) {
  Json scene = Json::parse(small_scene);
  scene["reference"] = "morph";
  scene["damping_ratio"] = 0.7;
  const std::string path =
      testing::TempDir() + "studio-" + std::to_string(::getpid()) + "-scene.json";
  const std::string out = path + ".out";
  std::ofstream(path) << scene.dump();
  const std::string command = std::string(NUNO_PROGRAM) + " optimize --refine " + path + " --out " +
                              out + " > /dev/null 2>&1";
  ASSERT_EQ(std::system(command.c_str()), 0);
  const Json expected = Json::parse(text_of(out));
  std::filesystem::remove(path);
  std::filesystem::remove(out);

  const Json plain = json_of(post("/api/optimize", scene.dump()));
  const Json aimed = json_of(post("/api/optimize?refine=1", scene.dump()));
  EXPECT_EQ(aimed["error"], expected["error"]);
  EXPECT_EQ(aimed["optimization"]["alpha"], plain["alpha"]);
  EXPECT_LT(aimed["error"]["mean"], plain["error"]["mean"]);
  const Json result = json_of(post("/api/result?refine=1", scene.dump()));
  EXPECT_EQ(result["final"], expected["final"]);
  EXPECT_EQ(result["optimization"]["refinement"]["aim_offset"],
            expected["optimization"]["refinement"]["aim_offset"]);
}

TEST_F(Studio, TradesErrorForEffort) {
  const Json answer = json_of(post("/api/trade_off", small_scene));
  const Json& curve = answer["trade_off"];
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
  EXPECT_EQ(refused("/api/simulate?alpha=nan", small_scene, 400),
            "alpha: \"nan\" is not a finite number");
  EXPECT_EQ(refused("/api/optimize?backend=bullet", small_scene, 400),
            "backend: \"bullet\" is not one of native, box2d");
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
  EXPECT_NE(refused("/api/optimize?refine=1", fine.dump(), 400).find("the most to aim off with"),
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
                           "/api/trade_off?page=a&backend=box2d", "/api/report?page=a"}) {
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

// What a careless or hostile program on the machine can send: 10 000 requests, from a seed.
TEST_F(Studio, AnswersEveryHostileRequestAndKeepsItsMemory) {
  constexpr int requests = 10'000, clients = 8, warm_up = 2'000;
  const auto random_request = [this](std::mt19937& random, bool& leaves) {
    const auto below = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
    const auto rubbish = [&](int most, bool printable) {
      std::string text(static_cast<std::size_t>(below(most)), ' ');
      for (char& c : text) {
        c = static_cast<char>(printable ? 33 + below(94) : below(256));
        if (c == '\n' || c == '\r') c = '.';
      }
      return text;
    };
    static const std::array paths = {"/api/optimize",
                                     "/api/simulate",
                                     "/api/result",
                                     "/api/scene",
                                     "/api/optimize?backend=native&frames=3",
                                     "/api/optimize?warm_start=0.1&refine=1",
                                     "/api/trade_off",
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
  };

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
