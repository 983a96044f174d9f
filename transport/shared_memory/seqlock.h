// Seqlock: a message in shared memory that one process writes and any number read. A reader never waits for the writer,
// which may have been stopped or killed in the middle: it obtains a complete message or none.
#pragma once

#include <span>

#include "transport/shared_memory/words.h"

namespace troupe {

// In front of the words of the message.
struct SeqlockHeader {
  Word sequence;  // 0: no message yet; odd: it is being written
  Word count;     // of the words
};

class SeqlockWriter {
 public:
  // Begins with a new message; the old one is no longer readable.
  SeqlockWriter(SeqlockHeader& header, std::span<Word> words) : header_(header), words_(words) {
    const std::uint64_t before = header_.sequence.load(std::memory_order_relaxed);
    next_ = (before | 1) + 1;  // of a writer that was killed it is odd
    header_.sequence.store(next_ - 1, std::memory_order_relaxed);
  }
  WordWriter& words() { return words_; }
  // The message is complete. False if it did not fit: then there is none.
  bool Finish() {
    const bool fits = words_.fits();
    header_.count.store(fits ? words_.count() : 0, std::memory_order_release);
    if (fits) header_.sequence.store(next_, std::memory_order_release);
    return fits;
  }

 private:
  SeqlockHeader& header_;
  WordWriter words_;
  std::uint64_t next_ = 0;
};

// Calls read(WordReader) with the message, if there is a complete one that is newer than `seen`, and sets `seen`. True
// if the words did not change meanwhile; otherwise the result of `read` is of no use. REQUIRES: `seen` is 0 or of an
// earlier call for the same header.
template <typename Read>
bool ReadNewer(const SeqlockHeader& header, std::span<const Word> words, std::uint64_t& seen, const Read& read) {
  const std::uint64_t sequence = header.sequence.load(std::memory_order_acquire);
  if (sequence == seen || sequence == 0 || sequence % 2 != 0) return false;
  const std::uint64_t count = header.count.load(std::memory_order_acquire);
  if (count > words.size()) {
    seen = sequence;  // no message has as many words: they were not written by a SeqlockWriter
    return false;
  }
  read(WordReader(words.first(static_cast<std::size_t>(count))));
  if (header.sequence.load(std::memory_order_relaxed) != sequence) return false;
  seen = sequence;
  return true;
}

}  // namespace troupe
