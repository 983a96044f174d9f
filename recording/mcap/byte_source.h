// ByteSource: the bytes of an MCAP file, at any offset.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "troupe/result.h"

namespace troupe::mcap {

class ByteSource {
 public:
  virtual ~ByteSource() = default;
  // Of the file, for error messages.
  virtual const std::string& name() const = 0;
  // As it was when the source was made.
  virtual std::uint64_t size() const = 0;
  // Fills `bytes` with those at `offset`. Throws std::system_error if the system cannot read them: that is no damage of
  // the file. REQUIRES: the range is within size().
  virtual void Read(std::uint64_t offset, std::span<std::byte> bytes) const = 0;
};

Result<std::unique_ptr<const ByteSource>> OpenFileSource(const std::string& path);

// `bytes` outlive the source.
std::unique_ptr<const ByteSource> MakeMemorySource(std::string name, std::span<const std::byte> bytes);

}  // namespace troupe::mcap
