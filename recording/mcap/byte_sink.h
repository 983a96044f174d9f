// ByteSink: the place to which an MCAP file is written.
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

// Creates the file, or empties it. Errors name the file; those of Write and Close have the code kOutputFailed. A file
// that another process writes is refused.
Result<std::unique_ptr<ByteSink>> CreateFileSink(const std::string& path);
// The same, but keeps the first `size` bytes of the file.
Result<std::unique_ptr<ByteSink>> AppendFileSink(const std::string& path, std::uint64_t size);

// Appends to `bytes`, which outlives the sink.
std::unique_ptr<ByteSink> MakeMemorySink(std::vector<std::byte>& bytes);

}  // namespace troupe::mcap
