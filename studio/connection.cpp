#include <utility>  // Asio forgets it

#include "studio/connection.h"

#include <boost/asio/buffer.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/http/error.hpp>
#include <boost/beast/http/read.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <variant>

#include <sys/socket.h>

#include "studio/clients.h"

namespace nuno::studio {
namespace {

namespace asio = boost::asio;
namespace http = boost::beast::http;
using asio::ip::tcp;
using namespace std::chrono_literals;

// How long a client may take; all are on this machine.
constexpr std::chrono::milliseconds idle_patience = 10s;
constexpr std::chrono::milliseconds head_patience = 5s;  // from its first byte to its last
constexpr std::chrono::milliseconds body_patience = 5s;  // the same
constexpr std::chrono::milliseconds leave_patience = 2s;
constexpr std::size_t slowest_reader = 1 << 20;  // bytes a second, after head_patience

constexpr std::size_t most_drained = 16 << 20;  // bytes

bool expects_continue(const http::fields& fields) {
  return boost::beast::iequals(fields[http::field::expect], "100-continue");
}

/// The refusal of what HTTP's own rules refuse.
Answer broken_answer(const boost::system::error_code& error) {
  if (error == http::error::header_limit || error == http::error::buffer_overflow) {
    return refusal(431, fmt::format("the head is larger than {} KiB", largest_head >> 10));
  }
  if (error == http::error::body_limit) {
    return refusal(413, fmt::format("the scene is larger than {} MB", largest_body >> 20));
  }
  return refusal(400, "the request is broken: " + error.message());
}

std::string head_text(const Answer& answer, bool stays) {
  const auto reason =
      http::obsolete_reason(http::int_to_status(static_cast<unsigned>(answer.status)));
  std::string text = fmt::format(
      "HTTP/1.1 {} {}\r\n"
      "Content-Length: {}\r\n"
      "Content-Type: {}\r\n"
      "Cache-Control: no-store\r\n"
      "Content-Security-Policy: default-src 'self'; img-src 'self' data: blob:; "
      "style-src 'self' 'unsafe-inline'; frame-ancestors 'none'; base-uri 'none'; "
      "form-action 'none'\r\n"
      "Cross-Origin-Resource-Policy: same-origin\r\n"
      "Referrer-Policy: no-referrer\r\n"
      "X-Content-Type-Options: nosniff\r\n"
      "Connection: {}\r\n",
      answer.status, std::string_view(reason.data(), reason.size()), answer.body.size(),
      answer.type, stays ? "keep-alive" : "close");
  if (!answer.allow.empty()) text += fmt::format("Allow: {}\r\n", answer.allow);
  if (!answer.file_name.empty()) {
    text += fmt::format("Content-Disposition: attachment; filename=\"{}\"\r\n", answer.file_name);
  }
  return text + "\r\n";
}

}  // namespace

Head head_of(const http::request_header<>& fields) {
  const auto text = [](auto view) { return std::string(view.data(), view.size()); };
  const auto all = [&](http::field name) {
    std::vector<std::string> values;
    const auto range = fields.equal_range(name);
    for (auto each = range.first; each != range.second; ++each) {
      values.push_back(text(each->value()));
    }
    return values;
  };
  const auto joined = [&](http::field name) {
    return fmt::format("{}", fmt::join(all(name), ", "));
  };
  return {text(fields.method_string()),
          text(fields.target()),
          all(http::field::host),
          all(http::field::origin),
          joined(http::field::content_type),
          joined(http::field::content_encoding),
          joined(http::field::transfer_encoding),
          fields.count(http::field::content_length) > 0};
}

Connection::Connection(tcp::socket socket, Site& site, Workers& workers, Clients& clients)
    : socket_(std::move(socket)),
      deadline_(socket_.get_executor()),
      site_(site),
      workers_(workers),
      clients_(clients),
      buffer_(largest_head) {}

void Connection::start() {
  Error error;
  socket_.set_option(tcp::no_delay(true), error);  // or an answer waits for its head's receipt
  socket_.non_blocking(true, error);
  wait_for_request();
}

void Connection::close() {
  const auto self = shared_from_this();
  turn_.end();
  deadline_.cancel();
  Error error;
  socket_.close(error);
  clients_.remove(self);
}

/// A state lasts `patience` at most, unless that is 0.
void Connection::enter(State state, std::chrono::milliseconds patience) {
  state_ = state;
  since_ = std::chrono::steady_clock::now();
  late_ = false;
  if (patience == 0ms) {
    deadline_.cancel();
    return;
  }
  deadline_.expires_after(patience);
  deadline_.async_wait([self = shared_from_this(), since = since_](Error error) {
    if (error || self->since_ != since || !self->socket_.is_open()) return;
    if (self->state_ != State::reading) return self->close();
    self->late_ = true;  // the reader says so to the client
    self->socket_.cancel(error);
  });
}

void Connection::wait_for_request() {
  enter(State::idle, idle_patience);
  held_ = 0;
  head_ = {};
  parser_.reset();
  if (buffer_.size() > 0) return read_head();
  buffer_.shrink_to_fit();
  socket_.async_wait(tcp::socket::wait_read, [self = shared_from_this()](Error error) {
    if (!error) self->read_head();
  });
}

void Connection::read_head() {
  enter(State::reading, head_patience);
  ++request_;
  parser_.emplace();
  parser_->header_limit(largest_head);
  parser_->body_limit(largest_body);
  http::async_read_header(
      socket_, buffer_, *parser_,
      [self = shared_from_this()](Error error, std::size_t) { self->on_head(error); });
}

void Connection::on_head(Error error) {
  // The length of a body is judged after who sends it.
  if (error && error != http::error::body_limit) return on_broken(error);
  head_ = head_of(parser_->get().base());
  const bool is_whole = !error && parser_->is_done();
  if (auto refusal = site_.refused(head_)) return send(std::move(*refusal), is_whole);
  if (error) return on_broken(error);
  if (head_.method != "POST") return send(site_.get(head_), is_whole);

  held_ = parser_->content_length() ? static_cast<std::size_t>(*parser_->content_length())
                                    : largest_body;
  clients_.make_room(shared_from_this());
  enter(State::reading, body_patience);
  if (!expects_continue(parser_->get().base())) return read_body();
  static constexpr std::string_view go_on = "HTTP/1.1 100 Continue\r\n\r\n";
  asio::async_write(socket_, asio::buffer(go_on.data(), go_on.size()),
                    [self = shared_from_this()](Error failed, std::size_t) {
                      failed ? self->close() : self->read_body();
                    });
}

void Connection::read_body() {
  http::async_read(socket_, buffer_, *parser_,
                   [self = shared_from_this()](Error error, std::size_t) { self->on_body(error); });
}

void Connection::on_body(Error error) {
  if (error) return on_broken(error);
  auto asked = site_.post(head_, std::move(parser_->get().body()));
  if (auto* answer = std::get_if<Answer>(&asked)) return send(std::move(*answer), true);
  begin(std::get<Work>(std::move(asked)));
}

/// A request that cannot be read to its end.
void Connection::on_broken(Error error) {
  if (!socket_.is_open()) return;
  if (late_) {
    const bool in_body = parser_->is_header_done();
    return send(in_body ? refusal(400, "the body of the request did not come in time")
                        : refusal(408, "the head of the request did not come in time"),
                false);
  }
  const bool is_cut = error == http::error::partial_message;
  const bool is_http = error.category() == make_error_code(http::error::bad_value).category();
  if (error == http::error::end_of_stream || (!is_http && !is_cut)) return close();
  send(broken_answer(error), false);
}

void Connection::begin(Work work) {
  enter(State::working, 0ms);
  turn_ = work.turn;
  const auto answer = [client = weak_from_this(), executor = socket_.get_executor(),
                       request = request_](Answer done) {
    asio::post(executor, [client, request, done = std::move(done)]() mutable {
      const auto self = client.lock();
      if (!self || !self->socket_.is_open() || self->request_ != request) return;
      Error error;
      self->socket_.cancel(error);  // the watch
      self->turn_ = {};
      self->send(std::move(done), true);
    });
  };
  if (!workers_.add(std::move(work), answer)) {
    turn_ = {};
    return send(refusal(503, "the studio has too much to do"), true);
  }
  watch();
}

/// While others work: a client that leaves ends its work, and what it sends next waits.
void Connection::watch() {
  socket_.async_wait(tcp::socket::wait_read,
                     [self = shared_from_this(), request = request_](Error error) {
                       if (error || self->state_ != State::working) return;
                       if (self->request_ == request) self->on_readable();
                     });
}

void Connection::on_readable() {
  constexpr std::size_t part = 4096;
  // No browser sends the next request before it has the answer.
  if (buffer_.size() + part > buffer_.max_size()) return close();
  Error error;
  const std::size_t size = socket_.read_some(buffer_.prepare(part), error);
  if (error && error != asio::error::would_block) return close();
  buffer_.commit(size);
  watch();
}

void Connection::send(Answer answer, bool stays) {
  stays_ = stays && parser_ && parser_->keep_alive();
  sent_head_ = head_text(answer, stays_);
  sent_body_ = head_.method == "HEAD" ? "" : std::move(answer.body);
  held_ = sent_body_.size();
  enter(State::writing, head_patience + std::chrono::seconds(held_ / slowest_reader));
  clients_.make_room(shared_from_this());
  asio::async_write(
      socket_, std::array{asio::buffer(sent_head_), asio::buffer(sent_body_)},
      [self = shared_from_this()](Error error, std::size_t) { self->on_sent(error); });
}

void Connection::on_sent(Error error) {
  sent_body_.clear();
  sent_body_.shrink_to_fit();
  if (error) return close();
  stays_ ? wait_for_request() : leave();
}

/// A client that is still sending would lose the answer if the socket were closed at once.
void Connection::leave() {
  enter(State::leaving, leave_patience);
  held_ = 0;
  Error error;
  socket_.shutdown(tcp::socket::shutdown_send, error);
  buffer_.clear();
  drain();
}

void Connection::drain() {
  socket_.async_read_some(buffer_.prepare(largest_head),
                          [self = shared_from_this()](Error error, std::size_t size) {
                            self->drained_ += size;
                            if (error || self->drained_ > most_drained) return self->close();
                            self->drain();
                          });
}

}  // namespace nuno::studio
