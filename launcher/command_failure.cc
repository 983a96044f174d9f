#include "launcher/command_failure.h"

#include <fmt/format.h>

#include <cstdio>

namespace troupe {

int Fail(int exit_status, const Error& error) {
  fmt::print(stderr, "{}\n", error.ToString());
  return exit_status;
}

}  // namespace troupe
