#include "studio/cancellation.h"

#include <algorithm>
#include <span>
#include <thread>

namespace nuno::studio {
namespace {

/// Gains of one portion: a few tenths of a second of work; whole SIMD packs on native, and a gain
/// for every core on an engine that flies them one by one.
std::size_t gains_of_portion(const Backend& backend) {
  const bool is_native = backend.name() == "native";
  const std::size_t least = is_native ? 16 : std::max(1u, std::thread::hardware_concurrency());
  return std::max(least, static_cast<std::size_t>((is_native ? 2e7 : 1e6) / work_of(backend)));
}

}  // namespace

Turn Turns::begin(const std::string& page) {
  Turn turn;
  if (page.empty()) return turn;
  turn.state_ = std::make_shared<Turn::State>();
  const std::scoped_lock lock(mutex_);
  auto& running = running_[page];
  if (running) running->over = true;
  running = turn.state_;
  return turn;
}

void Turns::end(const std::string& page, const Turn& turn) {
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

double work_of(const Backend& backend) {
  return static_cast<double>(backend.steps()) *
         static_cast<double>(backend.problem().cloth().particles());
}

Objective cancellable(const Backend& backend, const Turn& turn) {
  const std::size_t portion = gains_of_portion(backend);
  const auto in_portions = [turn, portion](auto evaluate) {
    return [turn, portion, evaluate](std::span<const double> gains) {
      turn.check();
      auto result = evaluate(gains.first(std::min(portion, gains.size())));
      for (std::size_t i = portion; i < gains.size(); i += portion) {
        turn.check();
        const auto part = evaluate(gains.subspan(i, std::min(portion, gains.size() - i)));
        result.insert(result.end(), part.begin(), part.end());
      }
      return result;
    };
  };
  Objective result = objective(backend);
  result.errors = in_portions(result.errors);
  if (result.samples) result.samples = in_portions(result.samples);
  return result;
}

}  // namespace nuno::studio
