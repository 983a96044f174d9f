#include "robot-agent/robot/scan_log.h"

#include <stdio_ext.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace troupe {
namespace {

// Removes the bytes after the last line end. False if the file cannot be truncated.
bool TruncateToWholeLines(std::FILE* file) {
  off_t end = 0;
  off_t position = 0;
  for (int c = std::getc(file); c != EOF; c = std::getc(file)) {
    ++position;
    if (c == '\n') end = position;
  }
  return ftruncate(fileno(file), end) == 0 && fseeko(file, end, SEEK_SET) == 0;
}

}  // namespace

Result<std::unique_ptr<ScanLog>> ScanLog::Open(const std::string& path, bool keep) {
  std::FILE* file = keep ? std::fopen(path.c_str(), "r+e") : nullptr;
  if (file != nullptr && !TruncateToWholeLines(file)) {
    std::fclose(file);
    file = nullptr;
  } else if (file == nullptr && (!keep || errno == ENOENT)) {
    file = std::fopen(path.c_str(), "we");
  }
  if (file == nullptr) return Error{{path}, std::string("cannot write scans here: ") + std::strerror(errno)};
  return std::unique_ptr<ScanLog>(new ScanLog(file, path));
}

ScanLog::~ScanLog() {
  std::fclose(file_);
}

void ScanLog::Write(const std::string& lines) {
  if (muted_) return;
  if (status_.ok() && std::fwrite(lines.data(), 1, lines.size(), file_) != lines.size()) Fail();
}

void ScanLog::Restart(std::uint32_t edition) {
  Write("{\"edition\":" + std::to_string(edition) + "}\n");
}

Status ScanLog::Flush() {
  if (status_.ok() && std::fflush(file_) != 0) Fail();
  return status_;
}

void ScanLog::Fail() {
  status_ = Error{{path_}, std::string("cannot write scans: ") + std::strerror(errno), ErrorCode::kOutputFailed};
  __fpurge(file_);  // a later attempt might write text behind a gap
}

}  // namespace troupe
