#include "robot-agent/robot/scan_log.h"

#include <fcntl.h>
#include <stdio_ext.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "common/base/file.h"
#include "common/base/line_file.h"

namespace troupe {
namespace {

// The bytes of the whole lines of the file; 0 if there is none.
Result<off_t> LengthOfWholeLines(const std::string& path) {
  std::error_code unknown;
  if (!std::filesystem::is_regular_file(path, unknown)) return off_t{0};
  Result<LineFile> file = LineFile::Open(path, LineFile::Space::kKeep);
  if (!file.ok()) return file.error();
  off_t length = 0;
  for (std::string line; file.value().Next(line);) length += static_cast<off_t>(line.size()) + 1;
  if (!file.value().status().ok()) return file.value().status().error();
  return length;
}

}  // namespace

Result<std::unique_ptr<ScanLog>> ScanLog::Open(const std::string& path, bool keep) {
  const Result<off_t> kept = keep ? LengthOfWholeLines(path) : Result<off_t>(0);
  if (!kept.ok()) return kept.error();
  Result<FileDescriptor> file = OpenToWrite(path, kept.value() == 0 ? O_TRUNC : 0);
  if (!file.ok()) return Error{{path}, "cannot write scans here: " + file.error().message, ErrorCode::kOutputFailed};
  const int descriptor = file.value().get();
  std::FILE* stream = nullptr;
  if (kept.value() == 0 ||
      (ftruncate(descriptor, kept.value()) == 0 && lseek(descriptor, kept.value(), SEEK_SET) == kept.value())) {
    stream = fdopen(descriptor, "w");
  }
  if (stream == nullptr) {
    return Error{{path}, std::string("cannot write scans here: ") + std::strerror(errno), ErrorCode::kOutputFailed};
  }
  (void)file.value().Release();  // the stream closes it
  return std::unique_ptr<ScanLog>(new ScanLog(stream, path));
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
