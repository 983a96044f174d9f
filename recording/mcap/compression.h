// Compression of the records of a chunk.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "troupe/result.h"

namespace troupe::mcap {

// Compresses one buffer after another with zstd, and keeps the memory that it needs.
class Compressor {
 public:
  Compressor();
  ~Compressor();
  Compressor(Compressor&& other) noexcept;
  Compressor& operator=(Compressor&& other) noexcept;

  // Replaces `to`.
  void Compress(std::span<const std::byte> from, std::vector<std::byte>& to);

 private:
  struct Context;
  std::unique_ptr<Context> context_;
};

// The bytes that zstd has compressed. The error is corrupt input, or another size than `size`. Memory grows only as
// bytes are decompressed, whatever `size` says.
Result<std::vector<std::byte>> Decompress(std::span<const std::byte> from, std::uint64_t size);

}  // namespace troupe::mcap
