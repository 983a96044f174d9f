// Files and memory as sinks and sources. An error of a sink stays: after a failed write the length of the file is not
// known, and later bytes would be at a wrong place. Sources are read at offsets (pread), so that several threads can
// read one. A vanished part of a file is an exception, because every caller would have to handle it at every number.
#include "recording/mcap/byte_stream.h"

#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string_view>
#include <system_error>
#include <utility>

#include "common/base/file.h"
#include "common/base/system_error.h"

namespace troupe::mcap {
namespace {

class FileSink final : public ByteSink {
 public:
  FileSink(std::string path, FileDescriptor file) : path_(std::move(path)), file_(std::move(file)) {}

  Status Write(std::span<const std::byte> bytes) override {
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    if (status_.ok() && !WriteAll(file_.get(), text))
      status_ = SystemError("cannot write", path_, ErrorCode::kOutputFailed);
    return status_;
  }
  Status Sync() override {
    if (status_.ok() && fdatasync(file_.get()) != 0)
      status_ = SystemError("cannot write", path_, ErrorCode::kOutputFailed);
    return status_;
  }
  Status Close() override {
    if (!file_.Close() && status_.ok()) status_ = SystemError("cannot close", path_, ErrorCode::kOutputFailed);
    return status_;
  }

 private:
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

class FileSource final : public ByteSource {
 public:
  FileSource(std::string path, FileDescriptor file, std::uint64_t size)
      : path_(std::move(path)), file_(std::move(file)), size_(size) {}

  const std::string& name() const override { return path_; }
  std::uint64_t size() const override { return size_; }
  void Read(std::uint64_t offset, std::span<std::byte> bytes) const override {
    while (!bytes.empty()) {
      const ssize_t count = pread(file_.get(), bytes.data(), bytes.size(), static_cast<off_t>(offset));
      if (count < 0 && errno == EINTR) continue;
      if (count < 0) throw std::system_error(errno, std::generic_category(), path_ + ": cannot read");
      if (count == 0)
        throw std::system_error(EIO, std::generic_category(), path_ + ": cannot read: the file has become shorter");
      bytes = bytes.subspan(static_cast<std::size_t>(count));
      offset += static_cast<std::uint64_t>(count);
    }
  }

 private:
  std::string path_;
  FileDescriptor file_;
  std::uint64_t size_;
};

class MemorySource final : public ByteSource {
 public:
  MemorySource(std::string name, std::span<const std::byte> bytes) : name_(std::move(name)), bytes_(bytes) {}

  const std::string& name() const override { return name_; }
  std::uint64_t size() const override { return bytes_.size(); }
  void Read(std::uint64_t offset, std::span<std::byte> bytes) const override {
    if (!bytes.empty()) std::memcpy(bytes.data(), bytes_.data() + offset, bytes.size());
  }

 private:
  std::string name_;
  std::span<const std::byte> bytes_;
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
  // Before the truncation: a running writer must not lose its file to a second one. The lock ends with the descriptor,
  // also of a killed process.
  if (flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    return Error{{path}, "cannot open for writing: another process writes this file", ErrorCode::kFailure};
  }
  struct stat info = {};
  const bool known = fstat(descriptor, &info) == 0;
  // A pipe or a device has no length to cut.
  if (known && !S_ISREG(info.st_mode)) return std::unique_ptr<ByteSink>(std::move(sink));
  const auto end = static_cast<off_t>(size);
  if (!known || ftruncate(descriptor, end) != 0 || lseek(descriptor, end, SEEK_SET) != end) {
    return SystemError("cannot write", path);
  }
  return std::unique_ptr<ByteSink>(std::move(sink));
}

std::unique_ptr<ByteSink> MakeMemorySink(std::vector<std::byte>& bytes) {
  return std::make_unique<MemorySink>(bytes);
}

Result<std::unique_ptr<const ByteSource>> OpenFileSource(const std::string& path) {
  Result<FileDescriptor> file = OpenToRead(path);
  if (!file.ok()) return Error{{path}, "cannot read: " + file.error().message};
  struct stat status = {};
  if (fstat(file.value().get(), &status) != 0) return SystemError("cannot read", path, ErrorCode::kBadInput);
  return std::unique_ptr<const ByteSource>(
      std::make_unique<FileSource>(path, std::move(file).value(), static_cast<std::uint64_t>(status.st_size)));
}

std::unique_ptr<const ByteSource> MakeMemorySource(std::string name, std::span<const std::byte> bytes) {
  return std::make_unique<MemorySource>(std::move(name), bytes);
}

}  // namespace troupe::mcap
