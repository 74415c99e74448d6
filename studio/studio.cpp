// `nuno studio`: the page, and the program behind it, on this machine alone.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <csignal>
#include <cstdlib>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <fcntl.h>
#include <spawn.h>
#include <sys/socket.h>
#include <unistd.h>

#include <nuno/output.h>
#include "embedded/chart_js.h"
#include "embedded/charts_js.h"
#include "embedded/client_js.h"
#include "embedded/editor_js.h"
#include "embedded/fields_js.h"
#include "embedded/files_js.h"
#include "embedded/geometry_js.h"
#include "embedded/index_html.h"
#include "embedded/keyboard_js.h"
#include "embedded/latency_js.h"
#include "embedded/numbers_js.h"
#include "embedded/player_js.h"
#include "embedded/scene_js.h"
#include "embedded/scores_js.h"
#include "embedded/stage_js.h"
#include "embedded/state_js.h"
#include "embedded/studio_css.h"
#include "embedded/studio_js.h"
#include "embedded/throws_js.h"
#include "embedded/view_js.h"
#include "studio/api.h"
#include "studio/studio.h"

// Last: the system's <resolv.h>, which it includes, defines names that Eigen uses.
#include <httplib.h>

namespace nuno {
namespace {

using studio::Answer;
using studio::refusal;

constexpr const char* host = "127.0.0.1";
constexpr std::size_t largest_body = 4 << 20;  // bytes; a drawn scene has some 5000
constexpr std::size_t longest_target = 2048;   // of a request: path and options
constexpr std::size_t threads = 32;            // an open connection of a browser holds one
constexpr int patience = 5;                    // seconds for a client that sends or reads nothing

struct PageFile {
  std::string_view path, type, text;
};

// A function: constants of other source files are made before main, in an unknown order.
std::array<PageFile, 20> page_files() {
  using namespace embedded;
  constexpr std::string_view js = "text/javascript; charset=utf-8";
  return {{{"/", "text/html; charset=utf-8", index_html},
           {"/studio.css", "text/css; charset=utf-8", studio_css},
           {"/chart.js", js, chart_js},
           {"/charts.js", js, charts_js},
           {"/client.js", js, client_js},
           {"/editor.js", js, editor_js},
           {"/fields.js", js, fields_js},
           {"/files.js", js, files_js},
           {"/geometry.js", js, geometry_js},
           {"/keyboard.js", js, keyboard_js},
           {"/latency.js", js, latency_js},
           {"/numbers.js", js, numbers_js},
           {"/player.js", js, player_js},
           {"/scene.js", js, scene_js},
           {"/scores.js", js, scores_js},
           {"/stage.js", js, stage_js},
           {"/state.js", js, state_js},
           {"/studio.js", js, studio_js},
           {"/throws.js", js, throws_js},
           {"/view.js", js, view_js}}};
}

std::string lower(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

/// Whether a request comes from this machine's own page: another site's page can have the browser
/// send requests here, but not under our name.
bool is_ours(const httplib::Request& request, int port) {
  if (request.get_header_value_count("Host") != 1) return false;
  const std::array names = {fmt::format("127.0.0.1:{}", port), fmt::format("localhost:{}", port)};
  const std::string name = lower(request.get_header_value("Host"));
  if (std::ranges::find(names, name) == names.end()) return false;
  if (!request.has_header("Origin")) return true;
  const std::string origin = lower(request.get_header_value("Origin"));
  return request.get_header_value_count("Origin") == 1 &&
         std::ranges::any_of(names, [&](const auto& n) { return origin == "http://" + n; });
}

/// Whether every part of the query is a name or name=value: httplib would read a=1=2 as a=2.
bool has_plain_query(std::string_view target) {
  int equals = 0;
  for (const char c : target.substr(std::min(target.find('?'), target.size()))) {
    equals = c == '&' ? 0 : equals + (c == '=');
    if (equals > 1) return false;
  }
  return true;
}

/// What is wrong with a request before its body is looked at.
std::optional<Answer> refused(const httplib::Request& request, int port) {
  if (request.target.size() > longest_target) {
    return refusal(414, fmt::format("the address is longer than {} characters", longest_target));
  }
  if (!is_ours(request, port)) {
    return refusal(403, "Host and Origin must be this page's own");
  }
  if (!has_plain_query(request.target)) {
    return refusal(400, "an option of the address has more than one value");
  }
  return std::nullopt;
}

/// Not with set_content: httplib would pack the answer as tightly as it can, which takes forty
/// milliseconds for a flight and saves nothing within one machine.
void send(httplib::Response& response, Answer answer) {
  response.status = answer.status;
  const std::size_t size = answer.body.size();
  response.set_content_provider(
      size, answer.type,
      [body = std::move(answer.body)](std::size_t offset, std::size_t length, auto& sink) {
        if (offset >= body.size()) return false;
        return sink.write(body.data() + offset, std::min(length, body.size() - offset));
      });
  if (!answer.file_name.empty()) {
    response.set_header("Content-Disposition",
                        fmt::format("attachment; filename=\"{}\"", answer.file_name));
  }
}

std::optional<PageFile> page_file(std::string_view path) {
  for (const PageFile& file : page_files()) {
    if (file.path == path) return file;
  }
  return std::nullopt;
}

Answer get(studio::Api& api, const httplib::Request& request) {
  if (const auto file = page_file(request.path)) {
    return {.type = std::string(file->type), .body = std::string(file->text)};
  }
  return api.get(request.path, request.params);
}

Answer post(studio::Api& api, const httplib::Request& request, std::string body) {
  if (page_file(request.path)) return refusal(405, request.path + ": takes GET");
  return api.post(request.path, request.params, std::move(body));
}

void set_routes(httplib::Server& server, studio::Api& api, int port) {
  server.set_default_headers(
      {{"Cache-Control", "no-store"},
       {"Content-Security-Policy",
        "default-src 'self'; img-src 'self' data: blob:; style-src 'self' 'unsafe-inline'; "
        "frame-ancestors 'none'; base-uri 'none'; form-action 'none'"},
       {"Cross-Origin-Resource-Policy", "same-origin"},
       {"Referrer-Policy", "no-referrer"},
       {"X-Content-Type-Options", "nosniff"}});

  // Requests without a body end here: httplib's routes are regular expressions, whose depth of
  // recursion goes with the length of the path.
  server.set_pre_routing_handler([&api, port](const auto& request, auto& response) {
    using Result = httplib::Server::HandlerResponse;
    // An answer is whole: httplib would cut it, or promise what it does not send.
    const_cast<httplib::Request&>(request).ranges.clear();
    const bool has_length = request.has_header("Content-Length");
    const bool is_chunked = request.has_header("Transfer-Encoding");
    if (request.method == "GET" || request.method == "HEAD") {
      const auto refusal = refused(request, port);
      send(response, refusal ? *refusal : get(api, request));
      return Result::Handled;
    }
    const bool takes_body = request.method == "POST" || request.method == "PUT" ||
                            request.method == "PATCH" || request.method == "DELETE";
    if (!takes_body) {
      send(response, refusal(405, "takes GET and POST"));
      response.set_header("Allow", "GET, HEAD, POST");
      return Result::Handled;
    }
    // httplib would read such a body until the connection ends.
    if (!has_length && !is_chunked) {
      send(response, refusal(411, "a Content-Length is missing"));
      return Result::Handled;
    }
    return Result::Unhandled;
  });

  // Whatever is wrong, the body is read to its end, or the connection could not go on; what is too
  // large, compressed or not, is not kept.
  const auto with_body = [&api, port](const httplib::Request& request, httplib::Response& response,
                                      const httplib::ContentReader& read) {
    std::string body;
    bool too_large = false;
    const bool whole = read([&](const char* data, std::size_t size) {
      too_large = too_large || body.size() + size > largest_body;
      if (too_large) {
        body.clear();
      } else {
        body.append(data, size);
      }
      return true;
    });
    if (const auto refusal = refused(request, port)) {
      send(response, *refusal);
    } else if (request.method != "POST") {
      send(response, studio::refusal(405, "takes GET and POST"));
      response.set_header("Allow", "GET, HEAD, POST");
    } else if (too_large || response.status == 413) {
      send(response,
           studio::refusal(413, fmt::format("the scene is larger than {} MB", largest_body >> 20)));
    } else if (!whole) {
      send(response, studio::refusal(400, "the body of the request is broken"));
    } else if (!lower(request.get_header_value("Content-Type")).starts_with("application/json")) {
      send(response, studio::refusal(415, "the Content-Type is not application/json"));
    } else {
      send(response, post(api, request, std::move(body)));
    }
  };
  server.Post(".*", with_body);
  server.Put(".*", with_body);
  server.Patch(".*", with_body);
  server.Delete(".*", with_body);

  // Answers that httplib gives by itself, to what is no HTTP.
  server.set_error_handler([](const httplib::Request&, httplib::Response& response) {
    if (!response.has_header("Content-Type")) {
      send(response, refusal(response.status, "the request is not one that the studio takes"));
    }
  });
  server.set_exception_handler(
      [](const httplib::Request&, httplib::Response& response, const std::exception_ptr&) {
        send(response, refusal(500, "the studio failed"));
      });
}

/// Runs the desktop's opener, where there is a desktop.
void open_browser(const std::string& address) {
  const auto is_set = [](const char* name) {
    const char* const value = std::getenv(name);
    return value && *value;
  };
#ifdef __APPLE__
  const char* const opener = "open";
#else
  const char* const opener = "xdg-open";
  if (!is_set("DISPLAY") && !is_set("WAYLAND_DISPLAY")) return;
#endif
  std::string program = opener, argument = address;
  std::array<char*, 3> arguments = {program.data(), argument.data(), nullptr};
  posix_spawn_file_actions_t quiet;
  posix_spawn_file_actions_init(&quiet);
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    posix_spawn_file_actions_addopen(&quiet, stream, "/dev/null", O_RDWR, 0);
  }
  pid_t child = 0;
  // Without an opener the printed address does.
  posix_spawnp(&child, opener, &quiet, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&quiet);
}

}  // namespace

void serve_studio(const StudioOptions& options) {
  httplib::Server server;
  server.new_task_queue = [] { return new httplib::ThreadPool(threads); };
  server.set_tcp_nodelay(true);  // or an answer waits for the acknowledgement of its header
  server.set_keep_alive_max_count(1'000'000);
  server.set_keep_alive_timeout(patience);
  server.set_read_timeout(patience);
  server.set_write_timeout(patience);
  server.set_payload_max_length(largest_body);
  // httplib's own choice lets two programs listen on one port, and each gets half the requests.
  server.set_socket_options([](auto socket) {
    const int yes = 1;
    setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  });

  int port = options.port;
  if (port == 0 || !server.bind_to_port(host, port)) {
    port = server.bind_to_any_port(host);
    if (port <= 0) throw OutputError("nuno studio: no port of 127.0.0.1 is free");
  }
  studio::Api api;
  set_routes(server, api, port);

  // Nothing to put away: the page keeps its scene by itself.
  std::signal(SIGINT, [](int) { _exit(0); });
  std::signal(SIGTERM, [](int) { _exit(0); });
  const std::string address = fmt::format("http://{}:{}/", host, port);
  if (options.port != 0 && port != options.port) {
    fmt::print("port {} is taken\n", options.port);
  }
  fmt::print("nuno studio: {}  (Ctrl-C ends it)\n", address);
  require_standard_output_written();
  if (options.opens_browser) open_browser(address);
  server.listen_after_bind();
}

}  // namespace nuno
