#pragma once

#include <nuno/points.h>

#include <functional>

namespace nuno {

/// Calls work(0) … work(count − 1), each once, in any order, on all cores; returns when all are
/// done. An exception of one of them is thrown here, once the others have stopped.
void parallel_for(Index count, const std::function<void(Index)>& work);

/// While it lives, parallel_for on this thread does its work on this thread alone: for one of
/// several who share the cores already.
class OnOneCore {
 public:
  OnOneCore();
  ~OnOneCore();
  OnOneCore(const OnOneCore&) = delete;
  OnOneCore& operator=(const OnOneCore&) = delete;

 private:
  bool before_;
};

}  // namespace nuno
