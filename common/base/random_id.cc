#include "common/base/random_id.h"

#include <random>

namespace troupe {

std::uint64_t MakeRandomId() {
  std::random_device device;
  return (std::uint64_t{device()} << 32) | device();
}

}  // namespace troupe
