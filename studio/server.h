#pragma once

#include <memory>

namespace nuno::studio {

/// Takes connections to a port of 127.0.0.1.
class Server {
 public:
  /// `wished` is 0 … 65535; 0, or one that is taken: any free one. Throws OutputError where none is
  /// free, or where no thread can be started.
  explicit Server(int wished);
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  int port() const;

  /// Serves until the program is ended.
  void run();

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace nuno::studio
