// libFuzzer at every door: the first byte of an input says which.

#include <cstddef>
#include <cstdint>
#include <string>

#include "fuzz/doors.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  nuno::fuzz::enter(static_cast<nuno::fuzz::Door>(data[0] % nuno::fuzz::doors),
                    std::string(data + 1, data + size));
  return 0;
}
