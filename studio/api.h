#pragma once

#include <functional>
#include <string>
#include <variant>

#include "studio/answers.h"
#include "studio/cancellation.h"
#include "studio/request.h"

namespace nuno::studio {

/// What takes its time: to be run once, by any thread, or to be thrown away.
struct Work {
  std::function<Answer()> run;
  Turn turn;  ///< ends it
};

/// What the page asks the program, see API.md. Used by any number of threads.
class Api {
 public:
  /// Answers everything, with a refusal where it must. What it throws is the machine's: no memory
  /// for the answer, no thread.
  Answer get(const std::string& path, const Parameters& parameters);

  /// A refusal at once, or the work that answers; it takes its page's turn here. This object must
  /// outlive it.
  std::variant<Answer, Work> post(const std::string& path, const Parameters& parameters,
                                  std::string body);

 private:
  Turns turns_;
};

}  // namespace nuno::studio
