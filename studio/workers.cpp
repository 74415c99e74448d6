#include "studio/workers.h"

#include <fmt/format.h>

#include <system_error>
#include <utility>

#include <nuno/output.h>

namespace nuno::studio {
namespace {

constexpr std::size_t most_waiting = 64;  // each with a body

Answer answer_of(const Work& work) {
  try {
    return work.run();
  } catch (...) {  // the machine's: no memory, no thread
    return refusal(500, "the studio failed");
  }
}

}  // namespace

Workers::Workers(std::size_t most) {
  try {
    while (threads_.size() < most) threads_.emplace_back([this] { run(); });
  } catch (const std::system_error& error) {
    if (threads_.empty()) {
      throw OutputError(fmt::format("nuno studio: no thread can be started: {}", error.what()));
    }
  }
}

Workers::~Workers() {
  const std::scoped_lock lock(mutex_);
  ending_ = true;
  changed_.notify_all();
}

bool Workers::add(Work work, std::function<void(Answer)> done) {
  std::vector<Task> over;  // while they waited: they make room
  bool has_room = false;
  {
    const std::scoped_lock lock(mutex_);
    for (Task& task : waiting_) {
      if (task.work.turn.is_over()) over.push_back(std::move(task));
    }
    std::erase_if(waiting_, [](const Task& task) { return !task.done; });
    has_room = waiting_.size() < most_waiting;
    if (has_room) waiting_.push_back({std::move(work), std::move(done)});
  }
  changed_.notify_one();
  for (const Task& task : over) task.done(answer_of(task.work));
  return has_room;
}

void Workers::run() {
  for (;;) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return ending_ || !waiting_.empty(); });
    if (ending_) return;
    Task task = std::move(waiting_.front());
    waiting_.pop_front();
    lock.unlock();
    Answer answer = answer_of(task.work);
    task.work = {};  // its scene, and its turn
    task.done(std::move(answer));
  }
}

}  // namespace nuno::studio
