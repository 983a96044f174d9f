// OrFailure: a call whose exceptions are failures.
#pragma once

#include <exception>

#include "troupe/result.h"

namespace troupe {

// The result of `call`, a Result or a Status; an exception becomes a failure.
template <typename Call>
auto OrFailure(const Call& call) -> decltype(call()) {
  try {
    return call();
  } catch (const std::exception& exception) {
    return FailureOf(exception);
  } catch (...) {
    return Failure("an exception without a description");
  }
}

}  // namespace troupe
