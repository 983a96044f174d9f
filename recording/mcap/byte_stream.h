// ByteSink and ByteSource: where an MCAP file is written to and read from: files, and memory for tests and branches. A
// sink is a stream to append to; a source is read at any offset, by any number of readers.
//
// A file is locked while a sink has it (flock), so that two services never write one recording; the lock ends with the
// process, however it ends. Errors of the system are told apart from damage: a source throws them, and the reader turns
// them into failures of its functions.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "troupe/result.h"

namespace troupe::mcap {

class ByteSink {
 public:
  virtual ~ByteSink() = default;
  // Appends bytes. After an error nothing more is written.
  virtual Status Write(std::span<const std::byte> bytes) = 0;
  // Waits until the bytes are on the disk.
  virtual Status Sync() { return {}; }
  virtual Status Close() = 0;
};

// Creates the file, or empties it. Errors name the file; errors of Write and Close have the code kOutputFailed. A file
// that another process writes is refused.
Result<std::unique_ptr<ByteSink>> CreateFileSink(const std::string& path);
// The same, but keeps the first `size` bytes of the file.
Result<std::unique_ptr<ByteSink>> AppendFileSink(const std::string& path, std::uint64_t size);

// Appends to `bytes`, which outlives the sink.
std::unique_ptr<ByteSink> MakeMemorySink(std::vector<std::byte>& bytes);

// ByteSource: the bytes of an MCAP file, at any offset.
class ByteSource {
 public:
  virtual ~ByteSource() = default;
  // The name of the file, for error messages.
  virtual const std::string& name() const = 0;
  // As it was when the source was made.
  virtual std::uint64_t size() const = 0;
  // Fills `bytes` with the bytes at `offset`. Throws std::system_error if the system cannot read them: that is no
  // damage of the file. REQUIRES: the range is within size().
  virtual void Read(std::uint64_t offset, std::span<std::byte> bytes) const = 0;
};

Result<std::unique_ptr<const ByteSource>> OpenFileSource(const std::string& path);

// `bytes` outlive the source.
std::unique_ptr<const ByteSource> MakeMemorySource(std::string name, std::span<const std::byte> bytes);

}  // namespace troupe::mcap
