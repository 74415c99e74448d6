#include <utility>  // Asio forgets it

#include "studio/server.h"

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>

#include <fmt/format.h>

#include <chrono>
#include <cstdint>
#include <exception>
#include <optional>

#include <nuno/output.h>
#include "studio/clients.h"
#include "studio/connection.h"
#include "studio/site.h"
#include "studio/workers.h"

namespace nuno::studio {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using Error = boost::system::error_code;

constexpr std::size_t threads = 8;  // a page has five kinds of work at most, and rarely two

/// Not with the option that lets two programs listen on one port, of which each gets half.
Error listen(tcp::acceptor& acceptor, int port) {
  Error error;
  if (acceptor.is_open()) acceptor.close(error);
  acceptor.open(tcp::v4(), error);
  if (!error) acceptor.set_option(tcp::acceptor::reuse_address(true), error);
  const tcp::endpoint place(asio::ip::address_v4::loopback(), static_cast<std::uint16_t>(port));
  if (!error) acceptor.bind(place, error);
  if (!error) acceptor.listen(tcp::acceptor::max_listen_connections, error);
  return error;
}

}  // namespace

struct Server::Parts {
  asio::io_context loop;
  tcp::acceptor acceptor{loop};
  asio::steady_timer pause{loop};
  std::optional<Site> site;
  Workers workers{threads};
  Clients clients;

  void accept() {
    acceptor.async_accept([this](Error error, tcp::socket socket) {
      if (!error) {
        const auto client =
            std::make_shared<Connection>(std::move(socket), *site, workers, clients);
        clients.add(client);
        client->start();
        return accept();
      }
      pause.expires_after(std::chrono::milliseconds(100));  // no descriptor is free
      pause.async_wait([this](Error) { accept(); });
    });
  }
};

Server::Server(int wished) : parts_(std::make_unique<Parts>()) {
  if (Error error = listen(parts_->acceptor, wished)) {
    error = listen(parts_->acceptor, 0);
    if (error) {
      throw OutputError(
          fmt::format("nuno studio: no port of 127.0.0.1 is free: {}", error.message()));
    }
  }
  parts_->site.emplace(port());
}

Server::~Server() = default;

int Server::port() const { return parts_->acceptor.local_endpoint().port(); }

void Server::run() {
  parts_->accept();
  for (;;) {
    try {
      parts_->loop.run();
      return;
    } catch (const std::exception&) {  // no memory: one client's loss, whose deadline remains
    }
  }
}

}  // namespace nuno::studio
