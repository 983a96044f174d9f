// The values of results that have to be there.
#pragma once

#include <stdexcept>
#include <utility>

#include "troupe/result.h"

namespace troupe::test {

// An error ends the test, as a failure with its message.
template <typename T>
T ValueOf(Result<T> result) {
  if (!result.ok()) throw std::runtime_error(result.error().ToString());
  return std::move(result).value();
}

}  // namespace troupe::test
