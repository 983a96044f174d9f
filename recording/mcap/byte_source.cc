#include "recording/mcap/byte_source.h"

#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <system_error>
#include <utility>

#include "common/base/file.h"

namespace troupe::mcap {
namespace {

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

Result<std::unique_ptr<const ByteSource>> OpenFileSource(const std::string& path) {
  Result<FileDescriptor> file = OpenToRead(path);
  if (!file.ok()) return Error{{path}, "cannot read: " + file.error().message};
  struct stat status = {};
  if (fstat(file.value().get(), &status) != 0)
    return Error{{path}, std::string("cannot read: ") + std::strerror(errno)};
  return std::unique_ptr<const ByteSource>(
      std::make_unique<FileSource>(path, std::move(file).value(), static_cast<std::uint64_t>(status.st_size)));
}

std::unique_ptr<const ByteSource> MakeMemorySource(std::string name, std::span<const std::byte> bytes) {
  return std::make_unique<MemorySource>(std::move(name), bytes);
}

}  // namespace troupe::mcap
