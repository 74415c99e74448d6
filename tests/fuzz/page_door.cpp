#include <utility>  // Asio forgets it

#include "fuzz/doors.h"

#include <boost/asio/buffer.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/string_body.hpp>

#include <condition_variable>
#include <mutex>
#include <nlohmann/json.hpp>
#include <stop_token>
#include <thread>
#include <variant>

#include "studio/connection.h"
#include "studio/site.h"

namespace nuno::fuzz {
namespace {

constexpr int port = 8471;  // that of the corpus

bool require_answer(const studio::Answer& answer) {
  require(answer.status >= 200 && answer.status < 600, "no status", answer.body);
  require(answer.status != 500, "the studio failed", answer.body);
  if (answer.type == "application/json") {
    require(nlohmann::json::accept(answer.body), "an answer is no JSON", answer.body);
    require(!answer.body.starts_with(R"({"error":"--)"), "speaks of an option", answer.body);
  }
  return answer.status == 200;
}

/// The answer to work that is ended after a while, as by a client that leaves.
studio::Answer done_in_time(const studio::Work& work, Patience patience) {
  std::mutex mutex;
  std::condition_variable_any ended;
  const std::jthread leaves([&](std::stop_token stop) {
    std::unique_lock lock(mutex);
    ended.wait_for(lock, stop, patience, [] { return false; });
    work.turn.end();
  });
  return work.run();
}

}  // namespace

bool enter_page(const std::string& input, Patience patience) {
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
  if (const auto refusal = site.refused(head)) return require_answer(*refusal);
  if (head.method != "POST") return require_answer(site.get(head));
  if (error || !parser.is_done()) return false;
  const auto asked = site.post(head, parser.get().body());
  const auto* const work = std::get_if<studio::Work>(&asked);
  return require_answer(work ? done_in_time(*work, patience) : std::get<studio::Answer>(asked));
}

}  // namespace nuno::fuzz
