#include "common/base/result.h"

namespace troupe {
namespace {

std::string Format(const SourceLocation& where, const char* severity, const std::string& message) {
  std::string text = where.file;
  if (!text.empty()) {
    if (where.line > 0) text += ":" + std::to_string(where.line);
    if (where.line > 0 && where.column > 0) text += ":" + std::to_string(where.column);
    text += ": ";
  }
  return text + severity + ": " + message;
}

}  // namespace

std::string Error::ToString() const {
  return Format(where, "error", message);
}

std::string Warning::ToString() const {
  return Format(where, "warning", message);
}

}  // namespace troupe
