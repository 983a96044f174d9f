// The values of results that have to be there.
#pragma once

#include <stdexcept>
#include <string>
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

namespace troupe {

// The message of an outcome, for comparisons: "" for success.
inline std::string MessageOf(const Status& status) {
  return status.ok() ? "" : status.error().message;
}

}  // namespace troupe
