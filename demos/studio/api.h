#pragma once

#include <map>
#include <string>

#include "cancellation.h"

namespace nuno::studio {

/// What a request gets.
struct Answer {
  int status = 200;  ///< of HTTP
  std::string type = "application/json";
  std::string body = {};
  std::string file_name = {};  ///< of a download; empty: none
};

/// {"error": message}
Answer refusal(int status, const std::string& message);

using Parameters = std::multimap<std::string, std::string>;

/// What the page asks the program, see API.md. Used by any number of threads.
class Api {
 public:
  /// Answers everything, with a refusal where it must; throws nothing but what memory makes it.
  Answer get(const std::string& path, const Parameters& parameters);
  Answer post(const std::string& path, const Parameters& parameters, const std::string& body);

 private:
  Turns turns_;
};

}  // namespace nuno::studio
