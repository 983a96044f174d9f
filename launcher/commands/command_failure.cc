#include "launcher/commands/command_failure.h"

#include <fmt/format.h>

#include <cstdio>

#include "command_line/exit_status.h"

namespace troupe {

int Fail(const Error& error) {
  fmt::print(stderr, "{}\n", error.ToString());
  return ExitStatusOf(error);
}

}  // namespace troupe
