#pragma once

#include <chrono>
#include <functional>
#include <string>

namespace nuno {

/// Says `announcement` of work that has not ended at once, then every half minute how long it has
/// taken of the `expected` seconds. `goes_on_for` waits for so long, and gives whether the work
/// still goes on.
void tell_of_long_work(const std::string& announcement, const std::string& label, double expected,
                       const std::function<bool(std::chrono::seconds)>& goes_on_for,
                       const std::function<void(const std::string&)>& say);

}  // namespace nuno
