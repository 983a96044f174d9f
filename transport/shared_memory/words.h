// Words: values in memory that several processes share, as atomic words of 64 bits. A word that is read while another
// process writes it has its old value or its new one, so that a reader needs no lock, only a check afterwards that
// nothing has changed (shared_layout.h).
//
// A number, an id or a flag is one word; a list or a text is its length and its elements, eight bytes of a text in a
// word; a type with fields (troupe/fields.h) is its fields, one after another; a variant is the number of its
// alternative, then the alternative.
//
// Writers store with release order and readers load with acquire order, which costs nothing on x86: a word is not seen
// before earlier ones.
#pragma once

#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "troupe/fields.h"
#include "troupe/ids.h"
#include "troupe/vec2.h"

namespace troupe {

using Word = std::atomic<std::uint64_t>;
static_assert(sizeof(Word) == sizeof(std::uint64_t) && Word::is_always_lock_free);

namespace words_internal {

template <typename Value>
inline constexpr bool kIsBytes = std::is_same_v<Value, std::string> || std::is_same_v<Value, std::vector<std::uint8_t>>;
template <typename Value>
inline constexpr bool kIsVariant = false;
template <typename... Alternatives>
inline constexpr bool kIsVariant<std::variant<Alternatives...>> = true;

// Calls visit.template operator()<Alternative>() for each alternative of a variant.
template <typename Variant, typename Visit>
constexpr void ForEachAlternative(Visit&& visit) {
  [&]<std::size_t... I>(std::index_sequence<I...>) {
    (visit.template operator()<std::variant_alternative_t<I, Variant>>(), ...);
  }
  (std::make_index_sequence<std::variant_size_v<Variant>>());
}

}  // namespace words_internal

// The words of a value without the elements of its lists and texts.
template <typename Value>
constexpr std::size_t LeastWords() {
  if constexpr (HasFields<Value>) {
    return std::apply(
        []<typename... Listed>(const Listed&...) { return (0 + ... + LeastWords<typename Listed::Part>()); },
        kFields<Value>);
  } else {
    return std::is_same_v<Value, Vec2> ? 2 : 1;
  }
}

// Whether all values of a type have as many words.
template <typename Value>
constexpr bool HasFixedWords() {
  if constexpr (HasFields<Value>) {
    return std::apply(
        []<typename... Listed>(const Listed&...) { return (... && HasFixedWords<typename Listed::Part>()); },
        kFields<Value>);
  } else {
    return !words_internal::kIsBytes<Value> && !kIsList<Value> && !words_internal::kIsVariant<Value> &&
           (!kIsOptional<Value> || kIsOptionalId<Value>);
  }
}

// A number for the words of a type: another one when its fields have other names, or another order.
template <typename Value>
constexpr std::uint64_t LayoutOf(std::uint64_t hash) {
  if constexpr (HasFields<Value>) {
    ForEachField<Value>([&]<typename Listed>(const Listed& field) {
      for (const char c : field.name) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3;  // FNV-1a
      hash = LayoutOf<typename Listed::Part>(hash * 0x100000001b3);
    });
  } else if constexpr (kIsList<Value> || kIsOptional<Value>) {
    hash = LayoutOf<typename Value::value_type>(hash);
  } else if constexpr (words_internal::kIsVariant<Value>) {
    words_internal::ForEachAlternative<Value>(
        [&]<typename Alternative>() { hash = LayoutOf<Alternative>(hash * 0x100000001b3); });
  }
  return hash;
}

class WordWriter {
 public:
  explicit WordWriter(std::span<Word> words) : words_(words) {}

  template <typename Value>
  void Add(const Value& value);

  // The number of added words, with the words that did not fit.
  std::size_t count() const { return count_; }
  bool fits() const { return count_ <= words_.size(); }

  static constexpr std::uint64_t kNone = ~std::uint64_t{0};

 private:
  void AddWord(std::uint64_t value) {
    if (count_ < words_.size()) words_[count_].store(value, std::memory_order_release);
    ++count_;
  }
  void AddBytes(const void* bytes, std::size_t size);

  std::span<Word> words_;
  std::size_t count_ = 0;
};

class WordReader {
 public:
  explicit WordReader(std::span<const Word> words) : words_(words) {}

  // False after the end of the words, and at one that is not of its type: a flag that is neither 0 nor 1, an unknown
  // enumerator, an id or a length that is too large. Numbers that are not finite and ids that no world has pass.
  template <typename Value>
  bool Read(Value& value);

  std::size_t remaining() const { return words_.size() - next_; }

 private:
  bool ReadWord(std::uint64_t& value, std::uint64_t most = std::numeric_limits<std::uint64_t>::max()) {
    if (next_ >= words_.size()) return false;
    value = words_[next_++].load(std::memory_order_acquire);
    return value <= most;
  }
  template <typename Bytes>
  bool ReadBytes(Bytes& bytes);

  std::span<const Word> words_;
  std::size_t next_ = 0;
};

template <typename Value>
void WordWriter::Add(const Value& value) {
  if constexpr (HasFields<Value>) {
    ForEachField<Value>([&](const auto& field) { Add(field.Of(value)); });
  } else if constexpr (words_internal::kIsBytes<Value>) {
    AddBytes(value.data(), value.size());
  } else if constexpr (kIsList<Value>) {
    AddWord(value.size());
    for (const auto& element : value) Add(element);
  } else if constexpr (kIsOptionalId<Value>) {
    AddWord(value ? std::uint64_t{value->index()} : kNone);
  } else if constexpr (kIsOptional<Value>) {
    AddWord(value ? 1 : 0);
    if (value) Add(*value);
  } else if constexpr (words_internal::kIsVariant<Value>) {
    AddWord(value.index());
    std::visit([&](const auto& alternative) { Add(alternative); }, value);
  } else if constexpr (kIsId<Value>) {
    AddWord(value.index());
  } else if constexpr (std::is_same_v<Value, Vec2>) {
    Add(value.x());
    Add(value.y());
  } else if constexpr (std::is_same_v<Value, double>) {
    AddWord(std::bit_cast<std::uint64_t>(value));
  } else {
    static_assert(std::is_unsigned_v<Value> || std::is_enum_v<Value>);
    AddWord(static_cast<std::uint64_t>(value));
  }
}

template <typename Value>
bool WordReader::Read(Value& value) {
  constexpr std::uint64_t most_id = std::numeric_limits<std::uint32_t>::max();
  std::uint64_t word = 0;
  if constexpr (HasFields<Value>) {
    return std::apply([&](const auto&... field) { return (... && Read(field.Of(value))); }, kFields<Value>);
  } else if constexpr (words_internal::kIsBytes<Value>) {
    return ReadBytes(value);
  } else if constexpr (kIsList<Value>) {
    // A false length is found before memory is allocated for it.
    if (!ReadWord(word) || word > remaining() / LeastWords<typename Value::value_type>()) return false;
    value.resize(static_cast<std::size_t>(word));
    for (auto& element : value) {
      if (!Read(element)) return false;
    }
    return true;
  } else if constexpr (kIsOptionalId<Value>) {
    if (!ReadWord(word) || (word > most_id && word != WordWriter::kNone)) return false;
    value.reset();
    if (word != WordWriter::kNone) value.emplace(static_cast<std::size_t>(word));
    return true;
  } else if constexpr (kIsOptional<Value>) {
    value.reset();
    return ReadWord(word, 1) && (word == 0 || Read(value.emplace()));
  } else if constexpr (words_internal::kIsVariant<Value>) {
    if (!ReadWord(word, std::variant_size_v<Value> - 1)) return false;
    std::uint64_t number = 0;
    bool is_read = false;
    words_internal::ForEachAlternative<Value>([&]<typename Alternative>() {
      if (number++ == word) is_read = Read(value.template emplace<Alternative>());
    });
    return is_read;
  } else if constexpr (kIsId<Value>) {
    if (!ReadWord(word, most_id)) return false;
    value = Value(static_cast<std::size_t>(word));
    return true;
  } else if constexpr (std::is_same_v<Value, Vec2>) {
    return Read(value.x()) && Read(value.y());
  } else if constexpr (std::is_same_v<Value, double>) {
    if (!ReadWord(word)) return false;
    value = std::bit_cast<double>(word);
    return true;
  } else if constexpr (std::is_enum_v<Value>) {
    if (!ReadWord(word, static_cast<std::uint64_t>(LastOf(Value())))) return false;
    value = static_cast<Value>(word);
    return true;
  } else {
    if (!ReadWord(word, std::numeric_limits<Value>::max())) return false;
    value = static_cast<Value>(word);
    return true;
  }
}

// The words that WordWriter::Add adds.
template <typename Value>
std::size_t CountWords(const Value& value) {
  if constexpr (HasFields<Value>) {
    return std::apply([&](const auto&... field) { return (0 + ... + CountWords(field.Of(value))); }, kFields<Value>);
  } else if constexpr (kIsList<Value> && !words_internal::kIsBytes<Value>) {
    using Element = typename Value::value_type;
    if constexpr (HasFixedWords<Element>()) return 1 + value.size() * LeastWords<Element>();
    std::size_t count = 1;
    for (const auto& element : value) count += CountWords(element);
    return count;
  } else {
    WordWriter none({});
    none.Add(value);
    return none.count();
  }
}

}  // namespace troupe
