#include "launcher/supervise/output_failure.h"

namespace troupe {

std::optional<Error> OutputFailure(const std::string& line, const std::string& path, const std::string& output) {
  const std::string start = path + ": error: ";
  const std::size_t at = line.find(start);
  if (path.empty() || at == std::string::npos || (at > 0 && line[at - 1] != ' ')) return std::nullopt;
  return Error{{output}, line.substr(at + start.size()), ErrorCode::kFailure};
}

}  // namespace troupe
