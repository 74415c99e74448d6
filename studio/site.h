#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "studio/answers.h"
#include "studio/api.h"

namespace nuno::studio {

constexpr std::size_t largest_head = 64 << 10;  // bytes
constexpr std::size_t largest_body = 4 << 20;   // bytes; a drawn scene has some 5000

/// What the studio looks at in the head of a request.
struct Head {
  std::string method, target;
  std::vector<std::string> hosts, origins;  ///< of each field of these names
  std::string content_type, content_encoding, transfer_encoding;
  bool has_length = false;
};

/// The page and its program behind a port: what a request gets, whoever sends it.
class Site {
 public:
  explicit Site(int port) : port_(port) {}

  /// What is wrong with a request before its body is looked at.
  std::optional<Answer> refused(const Head& head) const;

  /// To GET and HEAD, of a request that is not refused.
  Answer get(const Head& head);

  /// To POST, of a request that is not refused.
  std::variant<Answer, Work> post(const Head& head, std::string body);

 private:
  bool is_ours(const Head& head) const;

  int port_;
  Api api_;
};

}  // namespace nuno::studio
