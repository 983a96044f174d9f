// RunFilter: a command of the user that reads a text and writes another one, as planners of paths do.
#pragma once

#include <cstddef>
#include <string>

#include "launcher/process/process.h"
#include "troupe/result.h"

namespace troupe {

inline constexpr std::size_t kMaxFilterBytes = 64'000'000;

// Runs `command` by the shell, with `input` as its standard input, and returns its standard output; its standard error
// is that of this process. The error is a command that ends with another status than 0, writes more than
// kMaxFilterBytes, or is ended by a request to stop (`signals`).
Result<std::string> RunFilter(const std::string& command, const std::string& input, SignalWatch& signals);

}  // namespace troupe
