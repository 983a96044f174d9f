// Reading a text file as a whole.
#pragma once

#include <cstddef>
#include <string>

#include "common/base/allowed_paths.h"
#include "troupe/result.h"

namespace troupe {

// World files and scenarios are written by hand: anything larger is a mistake.
inline constexpr std::size_t kMaxTextFileBytes = 64'000'000;

// The content of a regular file that `allowed` allows. Errors are placed at `where`, which is the file itself or the
// place that names it.
Result<std::string> ReadTextFile(const std::string& path, const SourceLocation& where,
                                 const AllowedPaths& allowed = AllowedPaths::All());

// The message for a path that is not allowed. It does not tell whether the file exists.
std::string NotAllowed(const std::string& path, const AllowedPaths& allowed);

}  // namespace troupe
