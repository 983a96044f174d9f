// The bytes of files and messages: numbers and texts one after another, little-endian, without padding. A text is its
// length as std::uint32_t and its characters.
//
// Reader and writer are symmetric, so that a format is one list of calls read twice. Bytes of files and peers are not
// trusted: the reader never reads beyond its end, and a length from the bytes is compared with what remains before
// memory is taken. After a fault values are zero, so that callers test ok() once, at the end.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace troupe {

static_assert(std::endian::native == std::endian::little, "numbers are copied as they are in memory");

// A value that is its bytes in memory, whatever they are: a number, or a struct of integers without padding. No flag.
template <typename Value>
concept PlainBytes = !std::is_same_v<Value, bool> && std::is_trivially_copyable_v<Value> &&
                     (std::is_floating_point_v<Value> || std::has_unique_object_representations_v<Value>);

// ByteReader: reads bytes of unknown origin. After a value that does not fit into the bytes, ok() is false and all
// values are zero or empty. It does not own the bytes.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::byte> bytes) : bytes_(bytes) {}
  explicit ByteReader(std::string_view bytes) : bytes_(std::as_bytes(std::span<const char>(bytes))) {}

  bool ok() const { return ok_; }
  bool at_end() const { return bytes_.empty(); }
  std::size_t remaining() const { return bytes_.size(); }

  template <PlainBytes Value>
  Value Read() {
    Value value{};
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
    const std::span<const std::byte> bytes = bytes_.first(static_cast<std::size_t>(count));
    bytes_ = bytes_.subspan(bytes.size());
    return bytes;
  }
  // Bytes behind their length.
  template <typename Length>
  std::span<const std::byte> ReadWithLength() {
    return ReadBytes(Read<Length>());
  }
  std::string ReadText() { return TextOf(ReadWithLength<std::uint32_t>()); }
  // All that remains.
  std::string ReadRest() { return TextOf(ReadBytes(bytes_.size())); }

 private:
  static std::string TextOf(std::span<const std::byte> bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }

  std::span<const std::byte> bytes_;
  bool ok_ = true;
};

// ByteWriter: appends to a buffer, which is a std::vector<std::byte> or a std::string that outlives the writer.
template <typename Buffer = std::vector<std::byte>>
class ByteWriter {
 public:
  explicit ByteWriter(Buffer& buffer) : buffer_(buffer) {}

  std::size_t size() const { return buffer_.size(); }

  template <PlainBytes Value>
  void Write(Value value) {
    Replace(Grow(sizeof value), value);
  }
  void WriteBytes(std::span<const std::byte> bytes) {
    const std::size_t at = Grow(bytes.size());
    if (!bytes.empty()) std::memcpy(buffer_.data() + at, bytes.data(), bytes.size());
  }
  void WriteBytes(std::string_view bytes) { WriteBytes(std::as_bytes(std::span<const char>(bytes))); }
  void WriteText(std::string_view text) {
    Write(static_cast<std::uint32_t>(text.size()));
    WriteBytes(text);
  }

  // Writes the values that `content` writes, behind their length in bytes.
  template <typename Length, typename Content>
  void WriteWithLength(const Content& content) {
    const std::size_t at = Grow(sizeof(Length));
    content();
    Replace(at, static_cast<Length>(size() - at - sizeof(Length)));
  }

  // Writes a value again. REQUIRES: one of its type is at byte `at` of the buffer.
  template <PlainBytes Value>
  void Replace(std::size_t at, Value value) {
    std::memcpy(buffer_.data() + at, &value, sizeof value);
  }

 private:
  std::size_t Grow(std::size_t count) {
    const std::size_t at = buffer_.size();
    buffer_.resize(at + count);
    return at;
  }

  Buffer& buffer_;
};

}  // namespace troupe
