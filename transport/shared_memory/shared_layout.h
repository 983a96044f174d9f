// The layout of the memory that a world service shares with its agents: two files, one that only the service writes
// (frames), and one in which each agent has a slot (answers); and one for each map of the run's worlds. All processes
// have the same version of Troupe: a service and an agent of different layouts find it by the number in the header, and
// use the network.
//
// Every value that another process may write while it is read is an atomic word (words.h), so that a race is a wrong
// value, which checks find, and no undefined behaviour. Frames have two buffers: a reader of the newest is disturbed
// only when the service is already writing the frame after the next.
//
// Sizes are addresses, not memory: a buffer or slot gets real memory only as far as messages need it.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <span>

#include "transport/protocol/messages.h"
#include "transport/shared_memory/words.h"
#include "troupe/result.h"

namespace troupe {

// Futex: waiting for a change of a word that several processes share.

using FutexWord = std::atomic<std::uint32_t>;
static_assert(sizeof(FutexWord) == sizeof(std::uint32_t) && FutexWord::is_always_lock_free);

inline constexpr std::uint32_t kAllWaiters = ~std::uint32_t{0};

// Returns when the word is not `value`, when a thread of any process wakes one of the `groups` (bits) of this waiter,
// after `seconds`, or earlier. The memory may be read-only.
void FutexWait(const FutexWord& word, std::uint32_t value, double seconds, std::uint32_t groups = kAllWaiters);

// Wakes all that wait for the word in one of these groups.
void FutexWake(const FutexWord& word, std::uint32_t groups = kAllWaiters);

// Seqlock: a message in shared memory that one process writes and any number read. A reader never waits for the writer,
// which may have been stopped or killed in the middle: it obtains a complete message or none.

// Precedes the words of the message.
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

// Changes with the fields of messages; the number in it with this file and the words of values (words.h).
inline constexpr std::uint64_t kSharedLayout = LayoutOf<ProposalMessage>(LayoutOf<FrameMessage>(0x54726f7570650007));

inline constexpr std::size_t kPage = 4096;
inline constexpr std::size_t kSlots = 4096;  // agents of a run; more use the network
inline constexpr std::size_t kBuffers = 2;   // the newest frame, and the one that is being written
inline constexpr std::size_t kBufferBytes = std::size_t{64} << 20;
inline constexpr std::size_t kSlotBytes = std::size_t{512} << 10;

// Only the service writes these, so that no agent can change the frames of another one.
struct FramesHeader {
  Word layout;
  Word key;
  Word ended;  // not 0: frames travel over the network from now on
  // The descriptor and the bytes of a third file, the map of the world (RayMap), which never changes; 0 bytes: none.
  Word map;
  Word map_bytes;
  // Counts the frames that were published; the newest is in buffer `published` modulo kBuffers. Agents wait for it.
  alignas(64) FutexWord published;
  // The agent of each slot; 0: none; kClaimed: none, and none can have it.
  alignas(64) std::array<Word, kSlots> agents;
};

inline constexpr AgentId kClaimed = ~AgentId{0};  // no agent has this id

inline constexpr std::size_t kFramesHeaderBytes = (sizeof(FramesHeader) + kPage - 1) / kPage * kPage;
inline constexpr std::size_t kFramesBytes = kFramesHeaderBytes + kBuffers * kBufferBytes;

inline constexpr std::size_t BufferOffset(std::uint32_t published) {
  return kFramesHeaderBytes + (published % kBuffers) * kBufferBytes;
}
inline constexpr std::size_t kBufferWords = (kBufferBytes - sizeof(SeqlockHeader)) / sizeof(Word);

// All processes write these. They only decide when the service wakes up: false values cost time, no result.
struct AnswersHeader {
  // The low half of the number of the frame (`published`), above the number of answers that are missing. An agent
  // that answers this frame counts down; the one that reaches zero wakes the service, and so do all later ones.
  Word missing;
  alignas(64) FutexWord wakes;
};

// An agent claims its slot (SharedMemory::Claim) before it writes, and until it has left the slot.
struct SlotHeader {
  Word sent_at;  // of the message, in ns of CLOCK_MONOTONIC
  SeqlockHeader message;
};

inline constexpr std::size_t kAnswersBytes = kPage + kSlots * kSlotBytes;
inline constexpr std::size_t SlotOffset(std::size_t slot) {
  return kPage + slot * kSlotBytes;
}
inline constexpr std::size_t kSlotWords = (kSlotBytes - sizeof(SlotHeader)) / sizeof(Word);

inline constexpr std::uint64_t Missing(std::uint32_t frame, std::uint32_t count) {
  return (std::uint64_t{frame} << 32) | count;
}

// Frames, always with the whole state, and proposals between their messages and words.

void AddFrame(const FrameMessage& frame, WordWriter& words);
std::size_t CountFrameWords(const FrameMessage& frame);  // that AddFrame adds
void AddProposal(const ProposalMessage& message, WordWriter& words);

// These fill their messages, so that their memory is used again. An error: the words are no message; the output is then
// unspecified. Words that change meanwhile give an error, or a message of values that are each of their type: the
// receiver of a frame checks it by its world (CheckState), the run refuses numbers of a proposal that are not finite
// with an event that names the robot.
Status ReadFrame(WordReader words, FrameMessage& frame);
Status ReadProposal(WordReader words, ProposalMessage& message);

}  // namespace troupe
