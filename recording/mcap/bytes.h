// Bytes of MCAP files: records, checksums, compression.
//
// Numbers and texts have the form of common/base/bytes.h, which MCAP shares: little-endian, texts with a length of 32
// bits.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "common/base/bytes.h"
#include "recording/mcap/format.h"
#include "troupe/result.h"

namespace troupe::mcap {

// Writes a record; `content` writes its values.
template <typename Content>
void WriteRecord(ByteWriter<>& writer, Opcode opcode, const Content& content) {
  writer.Write(static_cast<std::uint8_t>(opcode));
  writer.WriteWithLength<std::uint64_t>(content);
}

// The CRC-32 of MCAP files, as zlib and PNG have it.
// `crc`: of all earlier bytes.
std::uint32_t Crc32(std::span<const std::byte> bytes, std::uint32_t crc = 0);

// Compression of the records of a chunk.

// Compresses one buffer after another with zstd, and keeps the memory that it needs.
class Compressor {
 public:
  Compressor();
  ~Compressor();
  Compressor(Compressor&& other) noexcept;
  Compressor& operator=(Compressor&& other) noexcept;

  // One that copies.
  static Compressor None();
  bool compresses() const { return context_ != nullptr; }

  // Replaces `to`.
  void Compress(std::span<const std::byte> from, std::vector<std::byte>& to);

 private:
  struct Context;
  std::unique_ptr<Context> context_;  // null: of None()
};

// The bytes that zstd has compressed. The error is corrupt input, or another size than `size`. Memory grows only as
// bytes are decompressed, whatever `size` says.
Result<std::vector<std::byte>> Decompress(std::span<const std::byte> from, std::uint64_t size);

}  // namespace troupe::mcap
