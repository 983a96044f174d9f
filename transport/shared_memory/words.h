// Words: values in memory that several processes share, as atomic words of 64 bits. A word that is read while another
// process writes it has its old value or its new one, so that a reader needs no lock, only a check afterwards that
// nothing has changed (seqlock.h).
//
// Writers store with release order and readers load with acquire order, which costs nothing on x86: a word is not seen
// before those that were written earlier.
#pragma once

#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace troupe {

using Word = std::atomic<std::uint64_t>;
static_assert(sizeof(Word) == sizeof(std::uint64_t) && Word::is_always_lock_free);

class WordWriter {
 public:
  explicit WordWriter(std::span<Word> words) : words_(words) {}

  void Add(std::uint64_t value) {
    if (count_ < words_.size()) words_[count_].store(value, std::memory_order_release);
    ++count_;
  }
  void Add(double value) { Add(std::bit_cast<std::uint64_t>(value)); }
  void Add(const std::string& text) { AddBytes(text.data(), text.size()); }
  void Add(const std::vector<std::uint8_t>& bytes) { AddBytes(bytes.data(), bytes.size()); }
  template <typename Id>
  void Add(const std::optional<Id>& id) {
    Add(id ? static_cast<std::uint64_t>(id->index()) : kNone);
  }

  // Of the words that were added, also of those that did not fit.
  std::size_t count() const { return count_; }
  bool fits() const { return count_ <= words_.size(); }

  static constexpr std::uint64_t kNone = ~std::uint64_t{0};

 private:
  void AddBytes(const void* bytes, std::size_t size);

  std::span<Word> words_;
  std::size_t count_ = 0;
};

// Each function returns false after the end of the words, and from a text or number that is not valid on.
class WordReader {
 public:
  explicit WordReader(std::span<const Word> words) : words_(words) {}

  bool Read(std::uint64_t& value) {
    if (next_ >= words_.size()) return false;
    value = words_[next_++].load(std::memory_order_acquire);
    return true;
  }
  bool Read(double& value) {
    std::uint64_t bits = 0;
    if (!Read(bits)) return false;
    value = std::bit_cast<double>(bits);
    return true;
  }
  bool ReadFinite(double& value);
  bool Read(bool& value);
  // At most `longest` bytes.
  bool Read(std::string& text, std::size_t longest) { return ReadBytes(text, longest); }
  bool Read(std::vector<std::uint8_t>& bytes, std::size_t longest) { return ReadBytes(bytes, longest); }
  // An id below `count`, or none.
  template <typename Id>
  bool Read(std::optional<Id>& id, std::uint64_t count) {
    std::uint64_t value = 0;
    if (!Read(value)) return false;
    id.reset();
    if (value == WordWriter::kNone) return true;
    if (value < count) id = Id(static_cast<std::size_t>(value));
    return value < count;
  }
  // The number of rows that follow, of at least `words` each.
  bool ReadCount(std::size_t& count, std::size_t words);

  std::size_t remaining() const { return words_.size() - next_; }

 private:
  template <typename Bytes>
  bool ReadBytes(Bytes& bytes, std::size_t longest);

  std::span<const Word> words_;
  std::size_t next_ = 0;
};

}  // namespace troupe
