#pragma once

#include <nuno/points.h>

#include <functional>
#include <stop_token>

namespace nuno {

/// Does `work` for each number 0 … count − 1, as they come, on `jobs` threads with a core each, and
/// what it returns on the calling thread, which so can write files and tell how far all is. Both
/// are called once for every number. At most as many returned ones as there are jobs wait for the
/// calling thread. An exception of either is thrown here, once the token has stopped the others.
void run_batch(Index count, Index jobs,
               const std::function<std::function<void()>(Index, std::stop_token)>& work);

}  // namespace nuno
