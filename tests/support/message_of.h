// The message of an outcome, for comparisons: "" for success.
#pragma once

#include <string>

#include "troupe/result.h"

namespace troupe {

inline std::string MessageOf(const Status& status) {
  return status.ok() ? "" : status.error().message;
}

}  // namespace troupe
