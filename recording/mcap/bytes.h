// Bytes of MCAP files: values read and written, checksums, compression.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "recording/mcap/format.h"
#include "troupe/result.h"

namespace troupe::mcap {

// ByteReader: reads the values of MCAP records from bytes of unknown origin. After a value that does not fit into the
// bytes, ok() is false and all values are empty.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  bool ok() const { return ok_; }
  bool at_end() const { return bytes_.empty(); }
  std::size_t remaining() const { return bytes_.size(); }

  template <typename Integer>
  Integer Read() {
    Integer value = 0;
    const std::span<const std::byte> bytes = ReadBytes(sizeof value);
    if (ok_) std::memcpy(&value, bytes.data(), sizeof value);
    return value;
  }
  std::span<const std::byte> ReadBytes(std::uint64_t count) {
    if (count > bytes_.size()) {
      ok_ = false;
      bytes_ = {};
      return {};
    }
    const std::span<const std::byte> bytes = bytes_.first(count);
    bytes_ = bytes_.subspan(count);
    return bytes;
  }
  // Bytes behind their length.
  template <typename Length>
  std::span<const std::byte> ReadWithLength() {
    return ReadBytes(Read<Length>());
  }
  std::string ReadText() {
    const std::span<const std::byte> bytes = ReadWithLength<std::uint32_t>();
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }

 private:
  std::span<const std::byte> bytes_;
  bool ok_ = true;
};

// ByteWriter: appends the values of MCAP records to a buffer.
class ByteWriter {
 public:
  // The buffer outlives the writer.
  explicit ByteWriter(std::vector<std::byte>& buffer) : buffer_(buffer) {}

  std::size_t size() const { return buffer_.size(); }

  // Little-endian, as all processors that Troupe runs on.
  template <typename Integer>
  void Add(Integer value) {
    Replace(Grow(sizeof value), value);
  }
  void Add(std::span<const std::byte> bytes) {
    const std::size_t at = Grow(bytes.size());
    if (!bytes.empty()) std::memcpy(buffer_.data() + at, bytes.data(), bytes.size());
  }
  void Add(std::string_view text) {
    Add(static_cast<std::uint32_t>(text.size()));
    Add(std::as_bytes(std::span<const char>(text)));
  }

  // Adds a record; `content` adds its values.
  template <typename Content>
  void AddRecord(Opcode opcode, const Content& content) {
    Add(static_cast<std::uint8_t>(opcode));
    AddWithLength<std::uint64_t>(content);
  }
  // Adds the length in bytes of the values that `content` adds, and these.
  template <typename Length, typename Content>
  void AddWithLength(const Content& content) {
    const std::size_t at = Grow(sizeof(Length));
    content();
    Replace(at, static_cast<Length>(buffer_.size() - at - sizeof(Length)));
  }

 private:
  std::size_t Grow(std::size_t count) {
    const std::size_t at = buffer_.size();
    buffer_.resize(at + count);
    return at;
  }
  template <typename Integer>
  void Replace(std::size_t at, Integer value) {
    std::memcpy(buffer_.data() + at, &value, sizeof value);
  }

  std::vector<std::byte>& buffer_;
};

// The CRC-32 of MCAP files: that of zlib and PNG.
// `crc`: of the bytes before.
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
