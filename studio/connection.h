#pragma once

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/string_body.hpp>

#include <chrono>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>

#include "studio/site.h"
#include "studio/workers.h"

namespace nuno::studio {

class Clients;

Head head_of(const boost::beast::http::request_header<>& fields);

/// One client: reads a request, has it answered, and so on until one of the two ends it. All of it
/// is done by the thread that runs the socket's loop; whatever a client does or leaves, no step
/// waits for it, and each has a deadline.
class Connection : public std::enable_shared_from_this<Connection> {
 public:
  /// In the order in which they give way where there are too many connections.
  enum class State { idle, leaving, reading, writing, working };

  Connection(boost::asio::ip::tcp::socket socket, Site& site, Workers& workers, Clients& clients);

  void start();
  /// At once; ends its work.
  void close();

  State state() const { return state_; }
  std::chrono::steady_clock::time_point since() const { return since_; }
  /// Memory that a client can have us hold until it has sent or read the rest [bytes].
  std::size_t held() const { return held_; }

 private:
  using Error = boost::system::error_code;

  void enter(State state, std::chrono::milliseconds patience);
  void wait_for_request();
  void read_head();
  void on_head(Error error);
  void read_body();
  void on_body(Error error);
  void on_broken(Error error);
  void begin(Work work);
  void watch();
  void on_readable();
  void send(Answer answer, bool stays);
  void on_sent(Error error);
  void leave();
  void drain();

  boost::asio::ip::tcp::socket socket_;
  boost::asio::steady_timer deadline_;
  Site& site_;
  Workers& workers_;
  Clients& clients_;

  State state_ = State::idle;
  std::chrono::steady_clock::time_point since_;
  bool late_ = false;        ///< a deadline cancelled what was under way
  std::size_t request_ = 0;  ///< counts them
  std::size_t held_ = 0;
  boost::beast::flat_buffer buffer_;
  std::optional<boost::beast::http::request_parser<boost::beast::http::string_body>> parser_;
  Head head_;
  Turn turn_;  ///< of the work under way
  std::string sent_head_, sent_body_;
  bool stays_ = false;       ///< for another request
  std::size_t drained_ = 0;  ///< bytes that nobody wants
};

}  // namespace nuno::studio
