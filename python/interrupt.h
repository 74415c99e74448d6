#pragma once

#include <functional>
#include <stop_token>

namespace nuno::python {

/// Does work while other threads of Python run. Where it is called by Python's main thread, the one
/// that a signal reaches, an exception of the signal's handler (Ctrl-C: KeyboardInterrupt) requests
/// `stop`, which ends the work at its next step, and is thrown here.
void without_lock(const std::function<void()>& work, const std::stop_source& stop);

}  // namespace nuno::python
