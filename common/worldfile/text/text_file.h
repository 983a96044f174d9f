// Reading a text file as a whole.
#pragma once

#include <cstddef>
#include <string>

#include "common/base/result.h"

namespace troupe {

// World files and scenarios are written by hand: anything larger is a mistake.
inline constexpr std::size_t kMaxTextFileBytes = 64'000'000;

// The content of a regular file. Errors are placed at `where`, which is the file itself or the place that names it.
Result<std::string> ReadTextFile(const std::string& path, const SourceLocation& where);

}  // namespace troupe
