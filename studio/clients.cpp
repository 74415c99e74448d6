#include "studio/clients.h"

#include <algorithm>
#include <cstddef>
#include <tuple>

namespace nuno::studio {
namespace {

constexpr std::size_t most_connections = 128;  // a browser has six for a page
constexpr std::size_t most_held = 32 << 20;    // bytes

}  // namespace

void Clients::add(const std::shared_ptr<Connection>& connection) {
  open_.insert(connection);
  make_room(connection);
}

void Clients::remove(const std::shared_ptr<Connection>& connection) { open_.erase(connection); }

void Clients::make_room(const std::shared_ptr<Connection>& newest) {
  const auto rank = [&](const std::shared_ptr<Connection>& each) {
    return std::tuple(each == newest, each->state(), each->since());
  };
  while (open_.size() > most_connections) (*std::ranges::min_element(open_, {}, rank))->close();

  using State = Connection::State;
  const auto gives_memory = [&](const std::shared_ptr<Connection>& each) {
    return each != newest && each->held() > 0 && each->state() != State::working;
  };
  for (;;) {
    std::size_t held = 0;
    for (const auto& each : open_) held += each->held();
    if (held <= most_held) return;
    auto oldest = open_.end();
    for (auto each = open_.begin(); each != open_.end(); ++each) {
      if (!gives_memory(*each)) continue;
      if (oldest == open_.end() || (*each)->since() < (*oldest)->since()) oldest = each;
    }
    if (oldest == open_.end()) return;
    (*oldest)->close();
  }
}

}  // namespace nuno::studio
