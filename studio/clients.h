#pragma once

#include <memory>
#include <set>

#include "studio/connection.h"

namespace nuno::studio {

/// The open connections. Closes those that wait for their clients where there are too many.
class Clients {
 public:
  void add(const std::shared_ptr<Connection>& connection);
  void remove(const std::shared_ptr<Connection>& connection);

  /// Closes connections, the idle first, of these the oldest, until the others are few enough and
  /// hold little enough memory; `newest` is the last to go.
  void make_room(const std::shared_ptr<Connection>& newest);

 private:
  std::set<std::shared_ptr<Connection>> open_;
};

}  // namespace nuno::studio
