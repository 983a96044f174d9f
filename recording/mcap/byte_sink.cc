#include "recording/mcap/byte_sink.h"

#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string_view>
#include <utility>

#include "common/base/file.h"

namespace troupe::mcap {
namespace {

class FileSink final : public ByteSink {
 public:
  FileSink(std::string path, FileDescriptor file) : path_(std::move(path)), file_(std::move(file)) {}

  Status Write(std::span<const std::byte> bytes) override {
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    if (status_.ok() && !WriteAll(file_.get(), text)) status_ = SystemError("cannot write: ");
    return status_;
  }
  Status Sync() override {
    if (status_.ok() && fdatasync(file_.get()) != 0) status_ = SystemError("cannot write: ");
    return status_;
  }
  Status Close() override {
    if (!file_.Close() && status_.ok()) status_ = SystemError("cannot close: ");
    return status_;
  }

 private:
  Error SystemError(const char* failed) const {
    return {{path_}, std::string(failed) + std::strerror(errno), ErrorCode::kOutputFailed};
  }

  std::string path_;
  FileDescriptor file_;
  Status status_;
};

class MemorySink final : public ByteSink {
 public:
  explicit MemorySink(std::vector<std::byte>& bytes) : bytes_(bytes) {}

  Status Write(std::span<const std::byte> bytes) override {
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    return {};
  }
  Status Close() override { return {}; }

 private:
  std::vector<std::byte>& bytes_;
};

}  // namespace

Result<std::unique_ptr<ByteSink>> CreateFileSink(const std::string& path) {
  return AppendFileSink(path, 0);
}

Result<std::unique_ptr<ByteSink>> AppendFileSink(const std::string& path, std::uint64_t size) {
  Result<FileDescriptor> opened = OpenToWrite(path);
  if (!opened.ok()) return Error{{path}, "cannot open for writing: " + opened.error().message, opened.error().code};
  const int descriptor = opened.value().get();
  auto sink = std::make_unique<FileSink>(path, std::move(opened).value());
  if (flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    return Error{{path}, "cannot open for writing: another process writes this file", ErrorCode::kFailure};
  }
  struct stat info = {};
  const bool known = fstat(descriptor, &info) == 0;
  if (known && !S_ISREG(info.st_mode)) return std::unique_ptr<ByteSink>(std::move(sink));
  const auto end = static_cast<off_t>(size);
  if (!known || ftruncate(descriptor, end) != 0 || lseek(descriptor, end, SEEK_SET) != end) {
    return Error{{path}, std::string("cannot write: ") + std::strerror(errno), ErrorCode::kFailure};
  }
  return std::unique_ptr<ByteSink>(std::move(sink));
}

std::unique_ptr<ByteSink> MakeMemorySink(std::vector<std::byte>& bytes) {
  return std::make_unique<MemorySink>(bytes);
}

}  // namespace troupe::mcap
