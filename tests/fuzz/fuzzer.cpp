// libFuzzer at one door: nuno-fuzzer --door=NAME NEW_INPUTS corpus/NAME.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <span>
#include <string>
#include <string_view>

#include "fuzz/doors.h"

namespace {

const nuno::fuzz::Door* door = nullptr;

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* count, char*** arguments) {
  constexpr std::string_view option = "--door=";
  for (const std::string_view argument : std::span(*arguments, static_cast<std::size_t>(*count))) {
    if (!argument.starts_with(option)) continue;
    const auto found =
        std::ranges::find(nuno::fuzz::doors, argument.substr(option.size()),
                          [](const auto& each) { return std::string_view(each.name); });
    if (found != nuno::fuzz::doors.end()) door = &*found;
  }
  if (door) return 0;
  std::fputs("which door? --door=NAME, one of", stderr);
  for (const auto& each : nuno::fuzz::doors) std::fprintf(stderr, " %s", each.name);
  std::fputs("\n", stderr);
  std::exit(2);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  nuno::fuzz::enter(*door, std::string(data, data + size));
  return 0;
}
