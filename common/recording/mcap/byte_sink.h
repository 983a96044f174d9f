// ByteSink: the place to which an MCAP file is written.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "common/base/result.h"

namespace troupe::mcap {

class ByteSink {
 public:
  virtual ~ByteSink() = default;
  // Appends bytes. After an error nothing more is written.
  virtual Status Write(std::span<const std::byte> bytes) = 0;
  virtual Status Close() = 0;
};

// Creates the file, or empties it. Errors name the file; those of Write and Close have the code kOutputFailed.
Result<std::unique_ptr<ByteSink>> CreateFileSink(const std::string& path);

// Appends to `bytes`, which outlives the sink.
std::unique_ptr<ByteSink> MakeMemorySink(std::vector<std::byte>& bytes);

}  // namespace troupe::mcap
