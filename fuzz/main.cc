// The entry of one target's program; the build names the target.
#include <cstdint>

#include "fuzz/targets.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  troupe::fuzz::TROUPE_FUZZ_TARGET(std::as_bytes(std::span(data, size)));
  return 0;
}
