// The layout of the memory that a world service shares with its agents: two files, one that only the service writes
// (frames), and one in which each agent has a slot (answers); and one for each map of the run's worlds. All processes
// have the same version of Troupe: a service and an agent of different layouts find it by the number in the header, and
// use the network.
#pragma once

#include <array>

#include "transport/protocol/messages.h"
#include "transport/shared_memory/futex.h"
#include "transport/shared_memory/seqlock.h"
#include "transport/shared_memory/words.h"

namespace troupe {

// Changes with the fields of messages; the number in it with this file and the words of values (words.h).
inline constexpr std::uint64_t kSharedLayout = LayoutOf<ProposalMessage>(LayoutOf<FrameMessage>(0x54726f7570650006));

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
  // By slot: its agent; 0: none; kClaimed: none, and none can have it.
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

}  // namespace troupe
