// AgentSegment: an agent's end of the memory that the world service of its machine shares: it reads frames and writes
// proposals. It can change neither frames nor the proposals of other agents.
//
// Threads: Wait and Read are for one thread at a time; all other functions for any.
//
// Two mappings: frames, read-only and sealed by the kernel, and the agent's own slot of the answers. Whatever is read
// is checked like a message from the network: the service may be stopped in the middle of a message. What it writes is
// a message in its own name; the service checks that.
//
// A frame is read straight into the caller's message, whose memory is used again: a tick allocates nothing in the long
// run.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <span>

#include "transport/protocol/messages.h"
#include "transport/shared_memory/shared_layout.h"
#include "transport/shared_memory/shared_memory.h"
#include "troupe/result.h"

namespace troupe {

class AgentSegment {
 public:
  // The error: why this process cannot use the memory.
  static Result<std::unique_ptr<AgentSegment>> Open(const SharingAddress& address);

  // Until there is a frame that Read has not returned. False: closed.
  bool Wait();

  enum class Outcome : std::uint8_t { kNothing, kFrame, kMalformed, kEnded };
  // The newest frame, unless it was read before. kEnded: all frames travel over the network from now on.
  Outcome Read(FrameMessage& frame);

  enum class Sent : std::uint8_t {
    kYes,
    kNotJoined,   // the service has not given a slot to this agent
    kImpossible,  // the message is too long, or there is no slot for this agent: it has to use the network
  };
  Sent Send(const ProposalMessage& proposal);

  // The map that the service shares, if its bytes are equal to these; otherwise null.
  std::shared_ptr<const std::byte> FindMap(std::span<const std::byte> bytes) const;

  // No thread waits any more when it returns, and none will.
  void Close();

 private:
  AgentSegment(pid_t service, MappedMemory frames, SharedMemory answers, MappedMemory header);

  const FramesHeader& frames() const { return frames_.At<FramesHeader>(0); }
  AnswersHeader& answers() const { return answers_header_.At<AnswersHeader>(0); }
  Sent FindSlot(AgentId agent);
  Sent Occupy(std::size_t slot, AgentId agent);
  // The proposal is an answer to the newest frame that was read.
  void Arrive();

  const pid_t service_;
  const MappedMemory frames_;
  const SharedMemory answers_;
  const MappedMemory answers_header_;
  const std::uint32_t group_;  // of the waiters that Close wakes
  std::atomic<std::uint32_t> read_ = 0;
  std::atomic<bool> waiting_ = false;
  std::atomic<bool> closing_ = false;

  std::mutex mutex_;                 // guards the members below
  std::optional<std::size_t> slot_;  // is claimed
  MappedMemory slot_memory_;
  std::size_t reserved_ = 0;               // bytes of the slot that have real memory
  std::optional<std::uint32_t> answered_;  // the newest frame that was answered
};

}  // namespace troupe
