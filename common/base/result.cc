#include "troupe/result.h"

#include <cstdio>
#include <cstdlib>
#include <new>

#include "common/base/text.h"
#include "troupe/check.h"

namespace troupe {
namespace {

std::string Format(const SourceLocation& where, const char* severity, const std::string& message) {
  std::string text = where.file;
  if (!text.empty()) {
    if (where.line > 0) text += ":" + std::to_string(where.line);
    if (where.line > 0 && where.column > 0) text += ":" + std::to_string(where.column);
    text += ": ";
  }
  return PlainLine(text + severity + ": " + message);
}

}  // namespace

std::string Error::ToString() const {
  return Format(where, "error", message);
}

std::string Warning::ToString() const {
  return Format(where, "warning", message);
}

Error FailureOf(const std::exception& exception) {
  const bool no_memory = dynamic_cast<const std::bad_alloc*>(&exception) != nullptr;
  return Failure(no_memory ? "there is not enough memory" : exception.what());
}

void CheckFailed(const char* condition, const char* file, int line) {
  std::fprintf(stderr, "%s:%d: internal error: check failed: %s\n", file, line, condition);
  std::abort();
}

}  // namespace troupe
