#pragma once

#include <nuno/flight_file.h>
#include <nuno/search.h>

#include <optional>
#include <string>

// What Python's callers give, checked at the door, in the words of the program's own options. Each
// throws InputError with the option, the value and the rule.

namespace nuno::python {

double non_negative(const char* option, double value);
double positive(const char* option, double value);
Index whole_number(const char* option, Index value, Index least, Index most);

void require_backend(const std::string& name);

/// The options of a search, each within its range, and all going together.
void require_right(const SearchOptions& options);

}  // namespace nuno::python
