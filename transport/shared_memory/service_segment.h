// ServiceSegment: the world service's end of the memory that it shares with the agents of its machine. It publishes
// frames, with one wake for all agents, and collects their proposals: each agent writes into a slot of its own, and the
// last one wakes the service.
//
// Whatever agents write is validated, and an agent can only send proposals in its own name. An agent claims its slot,
// and a slot that is claimed is given to no other agent: one that was stopped in the middle of a message, and lost
// since, would otherwise continue the message among the words of the other.
//
// The count of missing answers decides only when the service wakes up: if it is wrong, because an agent has died or
// wrote garbage, the service looks after a time.
//
// Threads: Wait and Collect are for one thread; all other functions for any.
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "transport/protocol/messages.h"
#include "transport/shared_memory/shared_layout.h"
#include "transport/shared_memory/shared_memory.h"
#include "transport/shared_memory/world_image.h"
#include "troupe/result.h"

namespace troupe {

// What an agent has written into its slot.
struct SharedAnswer {
  AgentId agent = 0;
  std::uint64_t sent_at = 0;  // as the agent says, in ns of CLOCK_MONOTONIC
  ProposalMessage proposal;   // of this agent, if not malformed
  Status malformed;
};

class ServiceSegment {
 public:
  // The error: why this machine cannot share memory.
  static Result<std::unique_ptr<ServiceSegment>> Create();

  const SharingAddress& address() const { return address_; }

  // Gives an agent a slot that no other one can write to. Without one it uses the network. An agent that has one keeps
  // it.
  void Bind(AgentId agent);
  void Unbind(AgentId agent);

  // An error if there is no memory for the frame. Then sharing has ended: the agents use the network from now on.
  Status Publish(const FrameMessage& frame);

  // Publishes the session with an image of its world. An error if the image cannot be made: then the agents receive
  // sessions over the network, and what follows them, too.
  Status PublishSession(const SessionMessage& session);

  // Until there may be new answers. False: closed.
  bool Wait();
  // The answers since the last call, in the order of their sending. Valid until the next call.
  std::span<const SharedAnswer> Collect();

  // The service has ended in order: the newest frame is the last. Nothing is published after it.
  void EndRun();

  // No thread waits any more when it returns, and none will.
  void Close();

 private:
  using Clock = std::chrono::steady_clock;
  struct Slot {
    AgentId agent = 0;        // 0: free
    std::uint64_t seen = 0;   // the newest message that was collected
    std::uint64_t round = 0;  // in which it arrived; 0: none yet
  };

  // A buffer of frames.
  struct Buffer {
    std::unique_ptr<SharedArena> arena;  // null: it was never used
    std::uint64_t content = 0;           // as FramesHeader::newest; 0: no frame
    FrameInPlace* frame = nullptr;
  };

  ServiceSegment(PlacedMemory frames, SharedMemory::OwnedMemory answers, const SharingAddress& address);

  FramesHeader& frames() const { return frames_.mapped->At<FramesHeader>(0); }
  AnswersHeader& answers() const { return answers_.mapped.At<AnswersHeader>(0); }
  // Whether no agent has the slot or can still write to it. REQUIRES: the mutex is held.
  bool IsFree(std::size_t slot);
  std::uint32_t CountExpected(const FrameMessage& frame) const;
  bool Read(Slot& slot, std::size_t index, SharedAnswer& answer) const;
  double LongestWait() const;
  void Wake();
  // Wakes the agents for the latest publication.
  void Announce();
  void End(SharingEnd end);
  // The first buffer that no agent reads, without the newest frame; nothing: agents read them all. REQUIRES: the mutex
  // is held.
  std::optional<std::size_t> FindFreeBuffer();
  bool BelongsToImage(const FrameMessage& frame) const;
  void Fill(Buffer& buffer, std::size_t index, const FrameMessage& frame);  // throws std::bad_alloc

  const PlacedMemory frames_;
  const SharedMemory::OwnedMemory answers_;
  const SharingAddress address_;
  std::uint32_t seen_wakes_ = 0;         // of Wait
  std::vector<SharedAnswer> collected_;  // of Collect; as many as `count` in use
  std::atomic<bool> waiting_ = false;
  std::atomic<bool> closing_ = false;

  mutable std::mutex mutex_;  // guards the members below
  std::vector<Slot> slots_;   // up to the last that was ever in use
  std::map<AgentId, std::size_t> slot_of_;
  std::array<Buffer, kBuffers> buffers_;
  std::uint32_t published_ = 0;  // frames
  std::size_t pins_ = 0;         // that agents may have claimed: the first ones
  std::uint64_t round_ = 1;      // counts the frames that all agents answer
  std::uint32_t missing_ = 0;    // answers to the newest frame that were expected and not collected
  Clock::time_point published_at_;
  double usual_seconds_ = 0.0;  // from a frame to its last answer
  bool ended_ = false;
  std::unique_ptr<WorldImage> image_;  // of the newest session; null: none
  Shared<WorldDescription> world_of_image_;
  Edition edition_of_image_ = 0;
};

}  // namespace troupe
