// Helpers of the converters (convert_*.h) between messages (transport/protocol/messages.h) and the types of idlc.
//
// A wire message is a C struct of idlc with pointers to its strings and sequences. To send one, its memory comes from a
// WireArena, freed as a whole; received ones are Cyclone's, and are only read. Texts and sequences of a received
// message may be null when they are empty.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace troupe::dds {

// Memory for the sequences and strings of a wire message. It is valid while the arena lives.
class WireArena {
 public:
  WireArena() = default;
  WireArena(const WireArena&) = delete;
  WireArena& operator=(const WireArena&) = delete;

  // A string of its own, ended by a zero.
  char* Copy(std::string_view text);

  // Allocates `count` elements for `sequence`, all zero, and returns the first.
  template <typename Sequence>
  auto* Fill(Sequence& sequence, std::size_t count) {
    using Element = std::remove_reference_t<decltype(*sequence._buffer)>;
    auto* elements = static_cast<Element*>(memory_.allocate(count * sizeof(Element), alignof(Element)));
    for (std::size_t i = 0; i < count; ++i) elements[i] = Element{};
    sequence._buffer = elements;
    sequence._length = sequence._maximum = static_cast<std::uint32_t>(count);
    sequence._release = false;  // the arena does that
    return elements;
  }

  template <typename Sequence>
  void FillStrings(Sequence& sequence, const std::vector<std::string>& strings) {
    char** out = Fill(sequence, strings.size());
    for (const std::string& text : strings) *out++ = Copy(text);
  }

 private:
  alignas(std::max_align_t) std::array<std::byte, 1024> first_;  // enough for most messages
  std::pmr::monotonic_buffer_resource memory_{first_.data(), first_.size()};
};

template <typename Sequence>
auto Elements(const Sequence& sequence) {
  using Element = std::remove_reference_t<decltype(*sequence._buffer)>;
  return std::span<const Element>(sequence._buffer, sequence._buffer == nullptr ? 0 : sequence._length);
}

// Columns of one table, as Elements returns them.
template <typename First, typename... Others>
bool SameLength(const First& first, const Others&... others) {
  return (... && (others.size() == first.size()));
}

// False if a message cannot be read because it has the changes since a message that is not the last one. Converters of
// such messages overload it.
template <typename Wire, typename Message>
bool CanRead(const Wire&, const Message&) {
  return true;
}

inline std::string Text(const char* text) {
  return text == nullptr ? std::string() : std::string(text);
}

template <typename Sequence>
std::vector<std::string> Strings(const Sequence& sequence) {
  std::vector<std::string> strings;
  strings.reserve(sequence._length);
  for (const char* text : Elements(sequence)) strings.push_back(Text(text));
  return strings;
}

}  // namespace troupe::dds
