#pragma once

#include <functional>
#include <stop_token>

namespace nuno::python {

/// From now on this thread's work ends at its next step once `stop` is requested.
void obey(std::stop_token stop);

/// Does work while other threads of Python run. Where it is called by Python's main thread, the one
/// that a signal reaches, an exception of the signal's handler (Ctrl-C: KeyboardInterrupt) requests
/// `stop`, which ends the work at its next step, and is thrown here. What the thread obeys requests
/// it too.
void without_lock(const std::function<void()>& work, const std::stop_source& stop);

}  // namespace nuno::python
