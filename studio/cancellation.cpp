#include "studio/cancellation.h"

namespace nuno::studio {

Turn Turns::begin(const std::string& page) {
  Turn turn;
  turn.state_ = std::make_shared<Turn::State>();
  if (page.empty()) return turn;
  const std::scoped_lock lock(mutex_);
  auto& running = running_[page];
  if (running) running->stop.request_stop();
  running = turn.state_;
  return turn;
}

void Turns::forget(const std::string& page, const Turn& turn) {
  const std::scoped_lock lock(mutex_);
  const auto running = running_.find(page);
  if (running != running_.end() && running->second == turn.state_) running_.erase(running);
}

Turn Turns::running(const std::string& page) {
  Turn turn;
  const std::scoped_lock lock(mutex_);
  const auto running = running_.find(page);
  if (running != running_.end()) turn.state_ = running->second;
  return turn;
}

}  // namespace nuno::studio
