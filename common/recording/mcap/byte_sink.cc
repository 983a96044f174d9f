#include "common/recording/mcap/byte_sink.h"

#include <fcntl.h>
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
  const int descriptor = open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor < 0) {
    return Error{{path}, std::string("cannot open for writing: ") + std::strerror(errno), ErrorCode::kFailure};
  }
  return std::unique_ptr<ByteSink>(std::make_unique<FileSink>(path, descriptor));
}

std::unique_ptr<ByteSink> MakeMemorySink(std::vector<std::byte>& bytes) {
  return std::make_unique<MemorySink>(bytes);
}

}  // namespace troupe::mcap
