#pragma once

// `nuno studio` as a client sees it that need not be a browser and need not be friendly.

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "program.h"

namespace nuno {

using Clock = std::chrono::steady_clock;

// A small scene: a throw of it takes a fraction of a millisecond.
inline const std::string small_scene =
    R"({"nuno_scene":1,"particles":8,"arrival_time":0.2,"initial":[[0,0],[1,0]],)"
    R"("target":[[1,0],[1,1]]})";

// One whose search takes a minute or more.
inline const std::string long_scene =
    R"({"nuno_scene":1,"particles":64,"arrival_time":2,"initial":[[0,0],[1,0]],)"
    R"("target":[[1,0],[1,1]]})";

/// One connection to the studio.
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

inline int status_of(const std::string& answer) {
  return answer.starts_with("HTTP/1.") ? std::atoi(answer.c_str() + 9) : 0;
}

inline std::string body_of(const std::string& answer) {
  const std::size_t end = answer.find("\r\n\r\n");
  return end == std::string::npos ? "" : answer.substr(end + 4);
}

inline Json json_of(const std::string& answer) {
  return Json::parse(body_of(answer), nullptr, false);
}

inline std::string message_of(const std::string& answer) {
  return json_of(answer).value("error", "");
}

/// A studio of its own for every test.
class Studio : public Program {
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

}  // namespace nuno
