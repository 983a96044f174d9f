#include "recording/mcap/byte_sink.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

namespace troupe::mcap {
namespace {

class FileSink final : public ByteSink {
 public:
  FileSink(std::string path, int descriptor) : path_(std::move(path)), descriptor_(descriptor) {}
  ~FileSink() override { static_cast<void>(Close()); }

  Status Write(std::span<const std::byte> bytes) override {
    while (status_.ok() && !bytes.empty()) {
      const ssize_t written = write(descriptor_, bytes.data(), bytes.size());
      if (written < 0 && errno == EINTR) continue;
      if (written < 0) {
        status_ = SystemError("cannot write: ");
      } else {
        bytes = bytes.subspan(static_cast<std::size_t>(written));
      }
    }
    return status_;
  }
  Status Sync() override {
    if (status_.ok() && fdatasync(descriptor_) != 0) status_ = SystemError("cannot write: ");
    return status_;
  }
  Status Close() override {
    const int descriptor = std::exchange(descriptor_, -1);
    if (descriptor >= 0 && close(descriptor) != 0 && status_.ok()) status_ = SystemError("cannot close: ");
    return status_;
  }

 private:
  Error SystemError(const char* failed) const {
    return {{path_}, std::string(failed) + std::strerror(errno), ErrorCode::kOutputFailed};
  }

  std::string path_;
  int descriptor_;
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
  const int descriptor = open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
  if (descriptor < 0) {
    return Error{{path}, std::string("cannot open for writing: ") + std::strerror(errno), ErrorCode::kFailure};
  }
  auto sink = std::make_unique<FileSink>(path, descriptor);
  if (flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    return Error{{path}, "cannot open for writing: another process writes this file", ErrorCode::kFailure};
  }
  struct stat info = {};
  if (fstat(descriptor, &info) != 0 || !S_ISREG(info.st_mode)) return std::unique_ptr<ByteSink>(std::move(sink));
  const auto end = static_cast<off_t>(size);
  if (ftruncate(descriptor, end) != 0 || lseek(descriptor, end, SEEK_SET) != end) {
    return Error{{path}, std::string("cannot write: ") + std::strerror(errno), ErrorCode::kFailure};
  }
  return std::unique_ptr<ByteSink>(std::move(sink));
}

std::unique_ptr<ByteSink> MakeMemorySink(std::vector<std::byte>& bytes) {
  return std::make_unique<MemorySink>(bytes);
}

}  // namespace troupe::mcap
