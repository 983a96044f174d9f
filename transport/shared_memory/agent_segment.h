// AgentSegment: an agent's end of the memory that the world service of its machine shares: it reads frames and writes
// proposals. It can change neither frames nor the proposals of other agents.
//
// Threads: Wait, ReadSession and Read are for one thread at a time; all other functions for any.
//
// Mappings: frames, read-only and sealed by the kernel, the agent's own slot of the answers, and the image of the
// world. Frames and worlds are read in place, without a copy and without checks: only the service can have written
// them, and publishes them when they are complete. What an agent writes is a message in its own name; the service
// checks that.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>

#include "transport/protocol/messages.h"
#include "transport/protocol/transport.h"
#include "transport/shared_memory/shared_layout.h"
#include "transport/shared_memory/shared_memory.h"
#include "troupe/result.h"

namespace troupe {

class AgentSegment {
 public:
  // The error: why this process cannot use the memory.
  static Result<std::unique_ptr<AgentSegment>> Open(const SharingAddress& address);
  ~AgentSegment();
  AgentSegment(const AgentSegment&) = delete;
  AgentSegment& operator=(const AgentSegment&) = delete;

  // Until something is published after the last call. False: closed. News that were read at the moment of their
  // publication end the next wait, too: Read then finds nothing.
  bool Wait();

  enum class Outcome : std::uint8_t {
    kNothing,
    kNews,
    kNetwork,  // all sessions and frames travel over the network from now on
    kRunOver,  // the service has ended in order, and its last frame was read
  };
  // The newest session, unless it was read before. Its world is in an image, and `prepared` has its scene. Never
  // kRunOver; with kNetwork, `reason` may say why.
  Outcome ReadSession(SessionMessage& session, PreparedWorld& prepared, Status& reason);
  // ReadSession returns the last one again.
  void ForgetSession() { session_ = 0; }
  // The newest frame, unless it was read before; nothing changes it until the next call or the end of this.
  Outcome Read(const FrameInPlace*& frame);

  enum class Sent : std::uint8_t {
    kYes,
    kNotJoined,   // the service has not given a slot to this agent
    kImpossible,  // the message is too long, or there is no slot for this agent: it has to use the network
  };
  Sent Send(const ProposalMessage& proposal);

  // No thread waits any more when it returns, and none will.
  void Close();

 private:
  AgentSegment(pid_t service, std::shared_ptr<const MappedMemory> frames, SharedMemory answers, MappedMemory header,
               std::size_t pin);

  const FramesHeader& frames() const { return frames_->At<FramesHeader>(0); }
  SharingEnd end() const { return static_cast<SharingEnd>(frames().end.load(std::memory_order_acquire)); }
  const FrameInPlace& FrameOf(std::uint64_t newest) const {
    return frames_->At<const FrameInPlace>(BufferOffset(BufferIn(newest)) + SharedArena::kFirstObject);
  }
  // The frame that was read until now is read no more.
  void SetPin(std::uint64_t newest);
  AnswersHeader& answers() const { return answers_header_.At<AnswersHeader>(0); }
  Sent FindSlot(AgentId agent);
  Sent Occupy(std::size_t slot, AgentId agent);
  // The proposal is an answer to the newest frame that was read.
  void Arrive();

  const pid_t service_;
  const std::shared_ptr<const MappedMemory> frames_;
  const SharedMemory answers_;
  const MappedMemory answers_header_;
  const std::size_t pin_;
  std::uint64_t pinned_ = 0;             // the value of the pin
  const std::uint32_t group_;            // of the waiters that Close wakes
  std::uint32_t awaited_ = 0;            // of Wait: what was published by the last call
  std::uint64_t session_ = 0;            // of ReadSession: the sequence number of the last one
  std::atomic<std::uint32_t> read_ = 0;  // the number of the newest frame that was read
  std::atomic<bool> waiting_ = false;
  std::atomic<bool> closing_ = false;

  std::mutex mutex_;                 // guards the members below
  std::optional<std::size_t> slot_;  // is claimed
  MappedMemory slot_memory_;
  std::size_t reserved_ = 0;               // bytes of the slot that have real memory
  std::optional<std::uint32_t> answered_;  // the newest frame that was answered
};

}  // namespace troupe
