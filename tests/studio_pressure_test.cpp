// What the studio bears: clients that never end a sentence, never read, or leave; and HTTP as it
// should be. Limits of time are those of "never": what fails here takes as long as it likes.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include <unistd.h>

#include "studio.h"

namespace nuno {
namespace {

class StudioUnderPressure : public Studio {
 protected:
  /// Processor time that the server has used [s].
  double processor_time() const {
    std::ifstream file("/proc/" + std::to_string(process_) + "/stat");
    std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
    std::istringstream fields(text.substr(text.rfind(')') + 1));
    std::string skipped;
    for (int i = 0; i < 11; ++i) fields >> skipped;
    double user = 0, system = 0;
    fields >> user >> system;
    return (user + system) / static_cast<double>(sysconf(_SC_CLK_TCK));
  }

  /// Seconds until the server computes no more; at most 20.
  double until_at_rest() const {
    constexpr auto window = 150ms;
    const auto start = Clock::now();
    double before = processor_time();
    while (Clock::now() - start < 20s) {
      std::this_thread::sleep_for(window);
      const double now = processor_time();
      if (now - before < 0.015) break;
      before = now;
    }
    return std::chrono::duration<double>(Clock::now() - start - window).count();
  }

  std::size_t open_files() const {
    const fs::directory_iterator files("/proc/" + std::to_string(process_) + "/fd");
    return static_cast<std::size_t>(std::distance(begin(files), end(files)));
  }

  /// Programs that the server runs.
  std::size_t children() const {
    std::size_t count = 0;
    for (const auto& task : fs::directory_iterator("/proc/" + std::to_string(process_) + "/task")) {
      std::ifstream file(task.path() / "children");
      for (int child = 0; file >> child;) ++count;
    }
    return count;
  }

  std::vector<std::unique_ptr<Connection>> connections(int count, const std::string& text) const {
    std::vector<std::unique_ptr<Connection>> clients;
    for (int i = 0; i < count; ++i) {
      clients.push_back(std::make_unique<Connection>(port_));
      clients.back()->send(text);
    }
    return clients;
  }

  std::string chunked(const std::string& body, const std::string& more = "") const {
    return head("POST /api/scene",
                "Content-Type: application/json\r\nTransfer-Encoding: chunked\r\n" + more) +
           "\r\n" + body;
  }
};

TEST_F(StudioUnderPressure, CutsAHeadWithoutEnd) {
  const double before = memory();
  const std::string part(1 << 16, 'x');
  for (const auto& [start, repeated] : std::vector<std::pair<std::string, std::string>>{
           {"GET / HTTP/1.1\r\n", "X-More: of this\r\n"},
           {"GET / HTTP/1.1\r\nX: ", part},
           {"GET /", part},
           {"", part}}) {
    const Connection client(port_);
    std::string text = start;
    while (text.size() < 8 << 20) text += repeated;
    client.send(text);
    const int status = status_of(client.receive());
    EXPECT_TRUE(status == 431 || (start.empty() && status == 400)) << start << status;
  }
  EXPECT_LT(memory(), before + 4e6);
  EXPECT_EQ(status_of(get("/")), 200);
}

TEST_F(StudioUnderPressure, AnswersBesideClientsThatNeverEndASentence) {
  const auto half = connections(64, "GET / HTTP/1.1\r\nHost: ");
  const auto bodies =
      connections(64, post_text("/api/scene", std::string(1000, ' ')).substr(0, 300));
  const auto silent = connections(64, "");
  const Connection client(port_);
  client.send(head("GET /api/about") + "\r\n");
  EXPECT_EQ(status_of(client.receive(5s)), 200);
}

/// What a client that goes on and on is answered; nothing after half a minute. Each part comes well
/// within any patience for a single one.
std::string answer_while_sending(const Connection& client, const std::string& part) {
  std::string answer;
  for (int i = 0; i < 60 && answer.empty(); ++i) {
    client.send(part);
    answer = client.receive(500ms);
  }
  return answer;
}

TEST_F(StudioUnderPressure, EndsAClientThatDribbles) {
  const std::string start =
      head("POST /api/scene", "Content-Type: application/json\r\nContent-Length: 99\r\n");
  for (const auto& [text, status] : {std::pair(start + "\r\n", 400), std::pair(start, 408)}) {
    const Connection client(port_);
    client.send(text);
    EXPECT_EQ(status_of(answer_while_sending(client, "x")), status);
  }
}

TEST_F(StudioUnderPressure, AsksWhoSendsBeforeItReadsABody) {
  const std::string foreign =
      "POST /api/scene HTTP/1.1\r\nHost: evil.example\r\n"
      "Content-Type: application/json\r\n";
  for (const char* body :
       {"Transfer-Encoding: chunked\r\n\r\n", "Content-Length: 99999999999\r\n\r\n"}) {
    const Connection client(port_);
    client.send(foreign + body);
    EXPECT_EQ(status_of(answer_while_sending(client, "1\r\nx\r\n")), 403);
  }
}

TEST_F(StudioUnderPressure, CutsAChunkedBodyWithoutEnd) {
  const double before = memory();
  const Connection client(port_);
  client.send(chunked(""));
  const std::string chunk = "10000\r\n" + std::string(1 << 16, ' ') + "\r\n";
  for (int i = 0; i < 70; ++i) client.send(chunk);
  EXPECT_EQ(status_of(answer_while_sending(client, chunk)), 413);
  EXPECT_LT(memory(), before + 20e6);
}

TEST_F(StudioUnderPressure, EndsTheWorkOfAClientThatLeft) {
  for (const char* path :
       {"/api/optimize", "/api/optimize?backend=box2d", "/api/pareto_front?backend=box2d",
        "/api/report", "/api/result", "/api/optimize?refine=1"}) {
    Json scene = Json::parse(long_scene);
    if (std::string(path).find("refine") != std::string::npos) {
      scene["reference"] = "morph";
      scene["damping_ratio"] = 0.7;
    }
    if (std::string(path).find("box2d") == std::string::npos) scene["time_step"] = 1e-5;  // long
    {
      const Connection client(port_);
      client.send(post_text(path, scene.dump()));
      std::this_thread::sleep_for(300ms);
      const double before = processor_time();
      std::this_thread::sleep_for(300ms);
      EXPECT_GT(processor_time(), before + 0.03) << path << " has ended before its client left";
    }
    const double seconds = until_at_rest();
    std::printf("%s: at rest %.2f s after its client left\n", path, seconds);
    EXPECT_LT(seconds, 10) << path;
  }
}

TEST_F(StudioUnderPressure, EndsTheFilmOfAClientThatLeft) {
  if (!is_installed("ffmpeg")) GTEST_SKIP() << "ffmpeg is not installed";
  Json scene = Json::parse(small_scene);
  scene["arrival_time"] = 10;
  scene["particles"] = 64;
  {
    const Connection client(port_);
    client.send(post_text("/api/film?alpha=0.01", scene.dump()));
    const auto patience = Clock::now() + 60s;
    while (children() == 0) {
      ASSERT_LT(Clock::now(), patience);
      std::this_thread::sleep_for(10ms);
    }
  }
  const auto left = Clock::now();
  while (children() > 0 && Clock::now() - left < 20s) std::this_thread::sleep_for(5ms);
  const double seconds = std::chrono::duration<double>(Clock::now() - left).count();
  std::printf("ffmpeg ended %.2f s after the client left\n", seconds);
  EXPECT_LT(seconds, 5);  // the film takes half a minute
}

TEST_F(StudioUnderPressure, AnswersAfterManyThatLeftTheirWork) {
  connections(100, post_text("/api/optimize?backend=box2d", long_scene));  // and closes them
  EXPECT_EQ(status_of(post("/api/optimize", small_scene)), 200);
  EXPECT_LT(until_at_rest(), 10);
}

TEST_F(StudioUnderPressure, RefusesWorkWhereTooMuchWaits) {
  const auto stubborn = connections(100, post_text("/api/optimize?backend=box2d", long_scene));
  // Who asks before all of them are read waits in their line.
  std::string answer;
  std::vector<std::unique_ptr<Connection>> waiting;
  for (int i = 0; i < 100 && answer.empty(); ++i) {
    const std::string page = "/api/optimize?page=b" + std::to_string(i);
    waiting.push_back(std::move(connections(1, post_text(page, small_scene)).front()));
    answer = waiting.back()->receive(300ms);
  }
  EXPECT_EQ(status_of(answer), 503) << message_of(answer);
  EXPECT_EQ(status_of(get("/api/about")), 200) << "those that compute are not those that answer";
}

TEST_F(StudioUnderPressure, KeepsFilesAndMemoryOfManyClientsThatNeverRead) {
  const std::string large = post_text("/api/simulate?alpha=0.1&frames=2000&after=1.9", small_scene);
  (void)exchange(large);
  const double before = memory();
  const std::size_t files = open_files();
  {
    const auto deaf = connections(300, large);
    const auto deaf_too = connections(200, head("GET /") + "\r\n");
    EXPECT_EQ(status_of(get("/api/about")), 200);
    std::printf("memory: %.1f MB more\n", (memory() - before) / 1e6);
    EXPECT_LT(memory(), before + 150e6);
    EXPECT_LE(open_files(), files + 130);
  }
  (void)until_at_rest();
  for (int i = 0; i < 100 && open_files() > files; ++i) std::this_thread::sleep_for(100ms);
  EXPECT_LE(open_files(), files);
}

TEST_F(StudioUnderPressure, BearsFiveHundredClientsOfTheWorstKind) {
  const std::string large = post_text("/api/simulate?alpha=0.1&frames=2000&after=1.9", small_scene);
  const int each = wished("NUNO_CLIENTS", 125);  // of a kind
  for (int i = 0; i < 3; ++i) (void)exchange(large);
  const double before = memory();
  const std::size_t files = open_files();
  double longest = 0, most = before;
  const auto ask = [&] {
    const auto start = Clock::now();
    EXPECT_EQ(status_of(post("/api/optimize?page=friend", small_scene)), 200);
    longest = std::max(longest, std::chrono::duration<double>(Clock::now() - start).count());
    most = std::max(most, memory());
  };
  auto silent = connections(each, "");
  ask();
  const auto half = connections(each, head("GET /", "X: "));
  ask();
  const auto deaf = connections(each, large);
  ask();
  connections(each, post_text("/api/optimize?backend=box2d", long_scene));  // gone in mid-work
  ask();
  for (int i = 0; i < 10; ++i) {  // dribbling
    for (const auto& client : half) client->send("x");
    std::this_thread::sleep_for(100ms);
    ask();
  }
  const auto start = Clock::now();
  while (open_files() > files && Clock::now() - start < 60s) std::this_thread::sleep_for(100ms);
  const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
  std::printf(
      "%d clients: another page waited %.3f s at most; memory %+.1f MB at most, %+.1f MB after; "
      "nothing of them left after %.1f s\n",
      4 * each, longest, (most - before) / 1e6, (memory() - before) / 1e6, seconds);
  EXPECT_LT(longest, 20);
  EXPECT_LT(memory(), before + 50e6);
  EXPECT_LE(open_files(), files) << "although all are still there";
  EXPECT_LT(until_at_rest(), 10);
}

TEST_F(StudioUnderPressure, KeepsItsMemoryAndFilesOverTwoThousandThrows) {
  const auto throws = [&](int count) {
    for (int i = 0; i < count; ++i) {
      const std::string page = i % 2 ? "&page=a" : "&page=b";
      EXPECT_EQ(status_of(post("/api/optimize?frames=100" + page, small_scene)), 200);
      if (i % 400 == 0) {
        EXPECT_EQ(status_of(post("/api/report", small_scene)), 200);
        EXPECT_EQ(status_of(post("/api/result", small_scene)), 200);
      }
    }
  };
  throws(400);
  const double before = memory();
  const std::size_t files = open_files();
  throws(1600);
  std::printf("2000 throws: memory %+.1f MB over the last 1600\n", (memory() - before) / 1e6);
  EXPECT_LT(memory(), before + 8e6);
  EXPECT_LE(open_files(), files + 1);
}

TEST_F(StudioUnderPressure, SpeaksHttp) {
  const std::string type = "Content-Type: application/json\r\n";
  for (const char* length : {"abc", "-1", "+2", "0x2", "2, 3", "99999999999999999999999", "1 1"}) {
    EXPECT_EQ(status_of(exchange(
                  head("POST /api/scene", type + "Content-Length: " + length + "\r\n") + "\r\n{}")),
              400)
        << length;
  }
  EXPECT_EQ(status_of(exchange(head("POST /api/scene", type + "Content-Length: 2\r\n"
                                                              "Transfer-Encoding: chunked\r\n") +
                               "\r\n0\r\n\r\n")),
            400);
  EXPECT_EQ(
      status_of(exchange(head("POST /api/scene", type + "Transfer-Encoding: gzip\r\n") + "\r\n")),
      501);
  EXPECT_EQ(status_of(exchange(head("POST /api/scene",
                                    "Content-Type: multipart/form-data; boundary=x\r\n"
                                    "Content-Length: 2\r\n") +
                               "\r\n--")),
            415);
  EXPECT_EQ(status_of(post("/api/scene", small_scene, "Content-Encoding: gzip\r\n")), 415);
  EXPECT_EQ(status_of(get("/api/about?%zz=1")), 400);
  EXPECT_EQ(status_of(get("/api%2Fabout")), 200);
}

TEST_F(StudioUnderPressure, TakesTheAbsoluteForm) {
  const std::string port = std::to_string(port_);
  EXPECT_EQ(status_of(get("http://127.0.0.1:" + port + "/api/about")), 200);
  EXPECT_EQ(status_of(get("HTTP://localhost:" + port)), 200);
  EXPECT_EQ(status_of(get("http://evil.example/api/about")), 403);
  EXPECT_EQ(status_of(get("http://127.0.0.1:" + port + "@evil.example/")), 403);
}

TEST_F(StudioUnderPressure, TakesChunksAndTrailers) {
  std::array<char, 16> size{};
  std::snprintf(size.data(), size.size(), "%zx\r\n", small_scene.size());
  const std::string body = size.data() + small_scene + "\r\n0\r\nX-Sum: 1\r\n\r\n";
  EXPECT_EQ(status_of(exchange(chunked(body, "Trailer: X-Sum\r\n"))), 200);
  // Who sends it was asked before: a trailer changes nothing.
  EXPECT_EQ(status_of(exchange(chunked("2\r\n{}\r\n0\r\nHost: evil.example\r\n\r\n"))), 400);
}

TEST_F(StudioUnderPressure, AnswersPipelinedRequestsInTheirOrder) {
  const Connection client(port_);
  client.send(post_text("/api/optimize", small_scene) + head("GET /api/about") + "\r\n" +
              head("GET /nothing") + "\r\n");
  std::string text = client.receive(2s);
  while (text.find("404 Not Found") == std::string::npos) {
    const std::string more = client.receive(10s);
    if (more.empty()) break;
    text += more;
  }
  const std::size_t first = text.find("\"alpha\""), second = text.find("\"version\""),
                    third = text.find("404 Not Found");
  EXPECT_LT(first, second);
  EXPECT_LT(second, third);
  EXPECT_NE(third, std::string::npos);
}

TEST_F(StudioUnderPressure, AsksForABodyThatWaitsToBeAskedFor) {
  const Connection client(port_);
  const std::string text = post_text("/api/scene", small_scene, "Expect: 100-continue\r\n");
  const std::size_t end = text.find("\r\n\r\n") + 4;
  client.send(text.substr(0, end));
  EXPECT_EQ(status_of(client.receive()), 100);
  client.send(text.substr(end));
  EXPECT_EQ(status_of(client.receive()), 200);
}

TEST_F(StudioUnderPressure, SpeaksOfNoOptionOfTheCommandLine) {
  const std::string answer = post("/api/simulate?alpha=1e300", small_scene);
  EXPECT_EQ(status_of(answer), 400);
  EXPECT_TRUE(message_of(answer).starts_with("alpha: 1e+300 is not <= ")) << message_of(answer);
}

}  // namespace
}  // namespace nuno
