#pragma once

#include <string>
#include <string_view>

#include "studio/answers.h"
#include "studio/cancellation.h"
#include "studio/request.h"

namespace nuno::studio {

/// What the page asks the program, see API.md. Used by any number of threads.
class Api {
 public:
  /// Answers everything, with a refusal where it must. What it throws is the machine's: no memory
  /// for the answer, no thread.
  Answer get(const std::string& path, const Parameters& parameters);
  Answer post(const std::string& path, const Parameters& parameters, std::string body);

 private:
  Answer answer(std::string_view method, const std::string& path, const Parameters& parameters,
                std::string body);

  Turns turns_;
};

}  // namespace nuno::studio
