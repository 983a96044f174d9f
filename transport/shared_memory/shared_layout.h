// The layout of the memory that a world service shares with its agents: one file that only the service writes (frames),
// one in which each agent has a slot (answers), and one for each world of the run (WorldImage). All processes have the
// same build of Troupe: a service and an agent of different layouts find it by the number in the header, and use the
// network.
//
// Frames are objects at addresses that are the same in all processes (SharedArena): an agent reads the newest in place.
// It says so first (Pin), and the service never writes into a frame that is the newest or that an agent reads; it uses
// another one of its many buffers. So no reader waits for the service or another reader, and the service for none.
//
// Every other value that a process may write while another one reads it is an atomic word (words.h), so that a race is
// a wrong value, which checks find, and no undefined behaviour.
//
// Sizes are addresses, not memory: a buffer or slot gets real memory only as far as messages need it.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <span>
#include <string>

#include "transport/protocol/messages.h"
#include "transport/shared_memory/shared_arena.h"
#include "transport/shared_memory/words.h"
#include "transport/shared_memory/world_image.h"
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

inline constexpr std::size_t kPage = 4096;
inline constexpr std::size_t kSlots = 4096;  // agents of a run; more use the network
// The newest frame, the one that is being written, and those that slow or stopped agents read.
inline constexpr std::size_t kBuffers = 63;
inline constexpr std::size_t kBufferBytes = kPlaceBytes / (kBuffers + 1);  // 128 MiB
inline constexpr std::size_t kSlotBytes = std::size_t{512} << 10;

// The session of a run, without its world: that is in an image.
struct SharedSession {
  RunId run = 0;
  std::uint32_t protocol_version = 0;
  std::string host;
  std::uint32_t pid = 0;
  double lease_seconds = 0.0;
  bool begun = false;
  Edition world_edition = 0;
  Incarnation incarnation = 0;
  WorldImagePlace image;
  bool operator==(const SharedSession&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"run", &SharedSession::run},
        Field{"protocol_version", &SharedSession::protocol_version},
        Field{"host", &SharedSession::host},
        Field{"pid", &SharedSession::pid},
        Field{"lease_seconds", &SharedSession::lease_seconds},
        Field{"begun", &SharedSession::begun},
        Field{"world_edition", &SharedSession::world_edition},
        Field{"incarnation", &SharedSession::incarnation},
        Field{"image", &SharedSession::image},
    };
  }
};
inline constexpr std::size_t kSessionWords = 256;

// Changes with the fields of messages, with the build, and with the number here, which is that of this file and of the
// words of values (words.h).
std::uint64_t SharedLayout();

// The end of what a service publishes in the memory.
enum class SharingEnd : std::uint64_t {
  kNotYet,
  kNetwork,  // sessions and frames travel over the network from now on
  kRunOver,  // the service has ended in order; the newest frame is the last
};

// Only the service writes these, so that no agent can change the frames of another one.
struct FramesHeader {
  Word layout;
  Word key;
  Word place;  // address of this memory
  Word end;    // a SharingEnd
  SeqlockHeader session;
  std::array<Word, kSessionWords> session_words;
  // Counts all that the service publishes: frames, sessions, the end. Agents wait for it.
  alignas(64) FutexWord published;
  // The newest frame: its number, from 1 on, above that of its buffer.
  alignas(64) Word newest;
  // The agent of each slot; 0: none; kClaimed: none, and none can have it.
  alignas(64) std::array<Word, kSlots> agents;
};

inline constexpr AgentId kClaimed = ~AgentId{0};  // no agent has this id

inline constexpr std::size_t kFramesHeaderBytes = (sizeof(FramesHeader) + kPage - 1) / kPage * kPage;
static_assert(kFramesHeaderBytes <= kBufferBytes);

inline constexpr std::size_t BufferOffset(std::size_t buffer) {
  return (buffer + 1) * kBufferBytes;
}
inline constexpr std::uint64_t Newest(std::uint32_t frame, std::size_t buffer) {
  return (std::uint64_t{frame} << 32) | buffer;
}
inline constexpr std::uint32_t FrameIn(std::uint64_t newest) {
  return static_cast<std::uint32_t>(newest >> 32);
}
inline constexpr std::size_t BufferIn(std::uint64_t newest) {
  return newest & 0xffffffff;
}

// The first object in a buffer; what it refers to follows in the buffer.
struct FrameInPlace {
  FrameMessage message;
  bool is_checked = false;  // the state belongs to the world of the session with the frame's edition
};
static_assert(alignof(FrameInPlace) <= SharedArena::kFirstObject);

// All processes write these. They only decide when the service wakes up: false values cost time, no result.
struct AnswersHeader {
  // The low half of the number of the frame (`published`), above the number of answers that are missing. An agent
  // that answers this frame counts down; the one that reaches zero wakes the service, and so do all later ones.
  Word missing;
  alignas(64) FutexWord wakes;
  alignas(64) FutexWord openings;  // of the memory by agents, so that each tries another pin first
};

// The frame that an agent reads, as in FramesHeader::newest; 0: none. A reader writes it, and then tests that the frame
// is still the newest: the service, which publishes a frame before it looks for a buffer, finds the pin or has changed
// the newest. An agent claims its pin (SharedMemory::Claim), so that the pin of one that has ended is found.
struct alignas(64) Pin {
  Word frame;
};
inline constexpr std::size_t kPins = kSlots + 64;  // agents that are about to join or to leave have pins, too

// For the thread sanitizer, which knows words by their addresses, and to which the pins of a service and of an agent in
// one process are different words: the accesses to a buffer before EndAccess precede those after BeginAccess.
#if defined(__has_feature)
#if __has_feature(thread_sanitizer)
#define TROUPE_THREAD_SANITIZER
#endif
#endif
#ifdef TROUPE_THREAD_SANITIZER
extern "C" void __tsan_acquire(void* address);
extern "C" void __tsan_release(void* address);
inline void BeginAccess(const void* buffer) {
  __tsan_acquire(const_cast<void*>(buffer));
}
inline void EndAccess(const void* buffer) {
  __tsan_release(const_cast<void*>(buffer));
}
#else
inline void BeginAccess(const void* /*buffer*/) {}
inline void EndAccess(const void* /*buffer*/) {}
#endif

// An agent claims its slot (SharedMemory::Claim) before it writes, and until it has left the slot.
struct SlotHeader {
  Word sent_at;  // of the message, in ns of CLOCK_MONOTONIC
  SeqlockHeader message;
};

inline constexpr std::size_t PinOffset(std::size_t pin) {
  return kPage + pin * sizeof(Pin);
}
inline constexpr std::size_t kAnswersHeaderBytes = (PinOffset(kPins) + kPage - 1) / kPage * kPage;
inline constexpr std::size_t SlotOffset(std::size_t slot) {
  return kAnswersHeaderBytes + slot * kSlotBytes;
}
inline constexpr std::size_t kAnswersBytes = SlotOffset(kSlots);
inline constexpr std::size_t kSlotWords = (kSlotBytes - sizeof(SlotHeader)) / sizeof(Word);

inline constexpr std::uint64_t Missing(std::uint32_t frame, std::uint32_t count) {
  return (std::uint64_t{frame} << 32) | count;
}

// Proposals between their messages and words.

void AddProposal(const ProposalMessage& message, WordWriter& words);

// Fills the message, so that its memory is used again. An error: the words are no message; the output is then
// unspecified. Words that change meanwhile give an error, or a message of values that are each of their type: the run
// refuses numbers of a proposal that are not finite with an event that names the robot.
Status ReadProposal(WordReader words, ProposalMessage& message);

}  // namespace troupe
