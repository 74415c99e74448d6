#include "studio/site.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <string_view>
#include <utility>

#include "studio/page_files.h"

namespace nuno::studio {
namespace {

constexpr std::size_t longest_target = 2048;  // path and options

std::string lower(std::string_view text) {
  std::string result(text);
  std::ranges::transform(result, result.begin(), [](unsigned char c) { return std::tolower(c); });
  return result;
}

/// A target, cut into its parts: "/path?query", or "http://authority/path?query".
struct Target {
  std::string_view authority;  ///< empty: Host has it
  std::string_view path, query;
};

Target cut(std::string_view target) {
  Target parts;
  constexpr std::string_view scheme = "http://";
  if (lower(target.substr(0, scheme.size())) == scheme) {
    target.remove_prefix(scheme.size());
    parts.authority = target.substr(0, target.find_first_of("/?"));
    target.remove_prefix(parts.authority.size());
  }
  parts.path = target.substr(0, target.find('?'));
  if (parts.path.size() < target.size()) parts.query = target.substr(parts.path.size() + 1);
  if (parts.path.empty()) parts.path = "/";
  return parts;
}

/// Text with its %XX, and in a query its +, put back; nothing where they are no encoding.
std::optional<std::string> decoded(std::string_view text, bool in_query) {
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '%') {
      unsigned char byte = 0;
      const char* const digits = text.data() + i + 1;
      if (i + 2 >= text.size() || std::from_chars(digits, digits + 2, byte, 16).ptr != digits + 2) {
        return std::nullopt;
      }
      result += static_cast<char>(byte);
      i += 2;
    } else {
      result += in_query && text[i] == '+' ? ' ' : text[i];
    }
  }
  return result;
}

/// Calls `see` with each part between '&'s.
template <typename See>
void for_each_option(std::string_view query, const See& see) {
  while (!query.empty()) {
    const std::string_view option = query.substr(0, query.find('&'));
    query.remove_prefix(std::min(option.size() + 1, query.size()));
    if (!option.empty()) see(option);
  }
}

/// What is asked for; nothing where it is not encoded as it should be.
struct Asked {
  std::string path;
  Parameters options;
};
std::optional<Asked> asked(const Target& target) {
  const std::optional<std::string> path = decoded(target.path, false);
  if (!path) return std::nullopt;
  Asked result{*path, {}};
  bool whole = true;
  for_each_option(target.query, [&](std::string_view option) {
    const std::string_view name = option.substr(0, option.find('='));
    const auto key = decoded(name, true);
    const auto value = decoded(option.substr(std::min(name.size() + 1, option.size())), true);
    whole = whole && key && value;
    if (whole) result.options.emplace(*key, *value);
  });
  return whole ? std::optional(result) : std::nullopt;
}

bool has_plain_options(std::string_view query) {
  bool plain = true;
  for_each_option(query, [&](std::string_view option) {
    plain = plain && std::ranges::count(option, '=') <= 1;
  });
  return plain;
}

Answer method_refusal(const std::string& message, std::string_view allow) {
  Answer answer = refusal(405, message);
  answer.allow = allow;
  return answer;
}

/// What is wrong with the announcement of a body.
std::optional<Answer> refused_body(const Head& head) {
  if (!head.transfer_encoding.empty() && lower(head.transfer_encoding) != "chunked") {
    return refusal(501, "the only Transfer-Encoding that is taken is chunked");
  }
  if (!head.has_length && head.transfer_encoding.empty()) {
    return refusal(411, "a Content-Length is missing");
  }
  if (!head.content_encoding.empty() && lower(head.content_encoding) != "identity") {
    return refusal(415, "the Content-Encoding is not identity");
  }
  if (!lower(head.content_type).starts_with("application/json")) {
    return refusal(415, "the Content-Type is not application/json");
  }
  return std::nullopt;
}

}  // namespace

/// Whether a request comes from this machine's own page: another site's page can have the browser
/// send requests here, but not under our name.
bool Site::is_ours(const Head& head) const {
  const std::array names = {fmt::format("127.0.0.1:{}", port_), fmt::format("localhost:{}", port_)};
  const auto is_name = [&](const std::string& text) {
    return std::ranges::find(names, text) != names.end();
  };
  if (head.hosts.size() != 1 || !is_name(lower(head.hosts.front()))) return false;
  const std::string authority = lower(cut(head.target).authority);
  if (!authority.empty() && !is_name(authority)) return false;
  if (head.origins.empty()) return true;
  const std::string origin = lower(head.origins.front());
  return head.origins.size() == 1 && origin.starts_with("http://") && is_name(origin.substr(7));
}

std::optional<Answer> Site::refused(const Head& head) const {
  if (head.target.size() > longest_target) {
    return refusal(414, fmt::format("the address is longer than {} characters", longest_target));
  }
  if (!is_ours(head)) return refusal(403, "Host and Origin must be this page's own");
  const Target target = cut(head.target);
  if (!has_plain_options(target.query)) {
    return refusal(400, "an option of the address has more than one value");
  }
  if (!asked(target)) return refusal(400, "a % of the address is not followed by two digits");
  if (head.method == "GET" || head.method == "HEAD") return std::nullopt;
  if (head.method != "POST") return method_refusal("takes GET and POST", "GET, HEAD, POST");
  return refused_body(head);
}

Answer Site::get(const Head& head) {
  const Asked wanted = asked(cut(head.target)).value();
  if (const auto file = page_file(wanted.path)) {
    return {.type = std::string(file->type), .body = std::string(file->text)};
  }
  return api_.get(wanted.path, wanted.options);
}

std::variant<Answer, Work> Site::post(const Head& head, std::string body) {
  const Asked wanted = asked(cut(head.target)).value();
  if (page_file(wanted.path)) return method_refusal(wanted.path + ": takes GET", "GET, HEAD");
  return api_.post(wanted.path, wanted.options, std::move(body));
}

}  // namespace nuno::studio
