#include "interrupt.h"

#include <pybind11/pybind11.h>

#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>

namespace nuno::python {
namespace {

namespace py = pybind11;

thread_local std::stop_token obeyed;

bool in_main_thread() {
  const py::module_ threading = py::module_::import("threading");
  const py::object main = threading.attr("main_thread")().attr("ident");
  return main.equal(threading.attr("get_ident")());
}

/// Work that goes on in a thread of its own.
class Work {
 public:
  explicit Work(const std::function<void()>& work)
      : thread_([this, &work] {
          try {
            work();
          } catch (...) {
            failure_ = std::current_exception();
          }
          const std::lock_guard lock(mutex_);
          is_done_ = true;
          done_.notify_all();
        }) {}

  bool is_done_within(std::chrono::milliseconds time) {
    std::unique_lock lock(mutex_);
    return done_.wait_for(lock, time, [this] { return is_done_; });
  }

  /// Waits for its end; what it threw.
  std::exception_ptr end() {
    thread_.join();
    return failure_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable done_;
  bool is_done_ = false;
  std::exception_ptr failure_;
  std::jthread thread_;  // the last: it uses the others
};

}  // namespace

void obey(std::stop_token stop) { obeyed = std::move(stop); }

void without_lock(const std::function<void()>& work, const std::stop_source& stop) {
  const std::stop_callback passed_on(obeyed, [&stop] { stop.request_stop(); });
  if (!in_main_thread()) {
    const py::gil_scoped_release unlocked;
    work();
    return;
  }
  constexpr std::chrono::milliseconds patience(20);  // between two looks at the signals
  std::exception_ptr failure;
  bool interrupted = false;
  PyThreadState* state = PyEval_SaveThread();
  {
    Work running(work);
    while (!running.is_done_within(patience)) {
      PyEval_RestoreThread(state);
      interrupted = PyErr_CheckSignals() != 0;
      state = PyEval_SaveThread();
      if (!interrupted) continue;
      stop.request_stop();
      break;
    }
    failure = running.end();
  }
  PyEval_RestoreThread(state);
  if (interrupted) throw py::error_already_set();
  if (failure) std::rethrow_exception(failure);
}

}  // namespace nuno::python
