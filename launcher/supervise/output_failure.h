// OutputFailure: the errors that processes of a run print about their output files.
#pragma once

#include <optional>
#include <string>

#include "troupe/result.h"

namespace troupe {

// The error of a line "PATH: error: MESSAGE", whatever text precedes the path, with the user's name `output` in place
// of the path; nothing if the line is another one. The code is kFailure.
std::optional<Error> OutputFailure(const std::string& line, const std::string& path, const std::string& output);

}  // namespace troupe
