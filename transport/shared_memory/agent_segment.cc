#include "transport/shared_memory/agent_segment.h"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <thread>
#include <utility>

#include "common/base/identity.h"

namespace troupe {
namespace {

constexpr double kMaxSleep = 10.0;  // s
constexpr std::uint64_t kGroups = 32;

}  // namespace

Result<std::unique_ptr<AgentSegment>> AgentSegment::Open(const SharingAddress& address) {
  if (address.machine != ThisMachine()) return Failure("it is of another user or container");
  auto frames = SharedMemory::Open(address.process, address.frames, kFramesBytes, SharedMemory::Peers::kMayRead);
  if (!frames.ok()) return frames.error();
  auto mapped = frames.value().Map(0, kFramesBytes);
  if (!mapped.ok()) return mapped.error();
  const FramesHeader& header = mapped.value().At<FramesHeader>(0);
  // The number of a descriptor may have been used again since the announcement.
  if (header.key != address.key || header.layout != kSharedLayout) {
    return Failure("the memory of process " + std::to_string(address.process) + " is of another run or version");
  }
  auto answers = SharedMemory::Open(address.process, address.answers, kAnswersBytes, SharedMemory::Peers::kMayWrite);
  if (!answers.ok()) return answers.error();
  auto answers_header = answers.value().Map(0, kPage);
  if (!answers_header.ok()) return answers_header.error();
  return std::unique_ptr<AgentSegment>(new AgentSegment(address.process, std::move(mapped).value(),
                                                        std::move(answers).value(), std::move(answers_header).value()));
}

AgentSegment::AgentSegment(pid_t service, MappedMemory frames, SharedMemory answers, MappedMemory header)
    : service_(service),
      frames_(std::move(frames)),
      answers_(std::move(answers)),
      answers_header_(std::move(header)),
      group_(std::uint32_t{1} << (MakeRandomId() % kGroups)) {}

// The descriptor and the size in the header may be of different maps, or old: then the bytes differ.
std::shared_ptr<const std::byte> AgentSegment::FindMap(std::span<const std::byte> bytes) const {
  if (bytes.empty() || frames().map_bytes != bytes.size()) return nullptr;
  const auto descriptor = static_cast<int>(frames().map);
  const auto memory = SharedMemory::Open(service_, descriptor, bytes.size(), SharedMemory::Peers::kMayRead);
  if (!memory.ok()) return nullptr;
  auto mapped = memory.value().Map(0, bytes.size());
  if (!mapped.ok()) return nullptr;
  const auto map = std::make_shared<const MappedMemory>(std::move(mapped).value());
  const std::byte* const begin = &map->At<const std::byte>(0);
  if (std::memcmp(begin, bytes.data(), bytes.size()) != 0) return nullptr;
  return {map, begin};
}

bool AgentSegment::Wait() {
  waiting_ = true;
  const std::uint32_t read = read_;
  while (!closing_ && frames().published.load(std::memory_order_acquire) == read) {
    FutexWait(frames().published, read, kMaxSleep, group_);
  }
  waiting_ = false;
  return !closing_;
}

void AgentSegment::Close() {
  closing_ = true;
  while (waiting_) {
    // Again and again until the waiter has left: it may be about to wait.
    FutexWake(frames().published, group_);  // also spurious wake-ups of other agents
    std::this_thread::yield();
  }
}

AgentSegment::Outcome AgentSegment::Read(FrameMessage& frame) {
  for (;;) {
    const std::uint32_t newest = frames().published.load(std::memory_order_acquire);
    if (closing_ || newest == read_) return Outcome::kNothing;
    if (frames().ended.load(std::memory_order_acquire) != 0) return Outcome::kEnded;
    const auto words = frames_.Array<const Word>(BufferOffset(newest) + sizeof(SeqlockHeader), kBufferWords);
    Status malformed;
    std::uint64_t seen = 0;
    const bool complete = ReadNewer(frames_.At<const SeqlockHeader>(BufferOffset(newest)), words, seen,
                                    [&](const WordReader& reader) { malformed = ReadFrame(reader, frame); });
    // Its buffer is used again only after another frame was published.
    if (!complete && newest != frames().published.load(std::memory_order_acquire)) continue;
    read_ = newest;
    return complete && malformed.ok() ? Outcome::kFrame : Outcome::kMalformed;
  }
}

AgentSegment::Sent AgentSegment::FindSlot(AgentId agent) {
  const auto& agents = frames().agents;
  if (slot_ && agents[*slot_].load(std::memory_order_acquire) == agent) return Sent::kYes;
  // The service has given the slot to no other agent while it was claimed.
  if (slot_) answers_.Release(SlotOffset(*slot_), kSlotBytes);
  slot_.reset();
  bool full = true;
  for (std::size_t i = 0; i < agents.size(); ++i) {
    const AgentId owner = agents[i].load(std::memory_order_acquire);
    if (owner == 0) full = false;
    if (owner != agent || agent == 0) continue;
    auto mapped = answers_.Map(SlotOffset(i), kSlotBytes);
    if (!mapped.ok()) return Sent::kImpossible;
    if (const Sent occupied = Occupy(i, agent); occupied != Sent::kYes) return occupied;
    slot_ = i;
    slot_memory_ = std::move(mapped).value();
    reserved_ = 0;
    return Sent::kYes;
  }
  return full ? Sent::kImpossible : Sent::kNotJoined;
}

// The service may have given the slot to another agent just before it was claimed. It does not afterwards.
AgentSegment::Sent AgentSegment::Occupy(std::size_t slot, AgentId agent) {
  const Result<bool> claimed = answers_.Claim(SlotOffset(slot), kSlotBytes);
  if (!claimed.ok()) return Sent::kImpossible;
  if (!claimed.value()) return Sent::kNotJoined;  // another agent is about to find that it has lost the slot
  if (frames().agents[slot].load(std::memory_order_acquire) == agent) return Sent::kYes;
  answers_.Release(SlotOffset(slot), kSlotBytes);
  return Sent::kNotJoined;
}

AgentSegment::Sent AgentSegment::Send(const ProposalMessage& proposal) {
  const std::lock_guard lock(mutex_);
  if (const Sent found = FindSlot(proposal.agent); found != Sent::kYes) return found;
  WordWriter counter({});
  AddProposal(proposal, counter);
  const std::size_t bytes = sizeof(SlotHeader) + counter.count() * sizeof(Word);
  if (bytes > kSlotBytes) return Sent::kImpossible;
  if (bytes > reserved_) {
    const std::size_t more = (bytes - reserved_ + kPage - 1) / kPage * kPage;
    if (!answers_.Reserve(SlotOffset(*slot_) + reserved_, more).ok()) return Sent::kImpossible;
    reserved_ += more;
  }
  SlotHeader& header = slot_memory_.At<SlotHeader>(0);
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  SeqlockWriter writer(header.message, slot_memory_.Array<Word>(sizeof(SlotHeader), kSlotWords));
  // For the order of answers, which the service sees only slot by slot.
  header.sent_at.store(static_cast<std::uint64_t>(std::chrono::nanoseconds(now).count()), std::memory_order_release);
  AddProposal(proposal, writer.words());
  writer.Finish();
  Arrive();
  return Sent::kYes;
}

void AgentSegment::Arrive() {
  const std::uint32_t frame = read_;
  std::uint64_t missing = answers().missing.load(std::memory_order_acquire);
  while (answered_ != frame) {
    if (static_cast<std::uint32_t>(missing >> 32) != frame) return;  // a newer frame follows, and is answered too
    const auto count = static_cast<std::uint32_t>(missing);
    if (count == 0) break;
    if (!answers().missing.compare_exchange_weak(missing, missing - 1, std::memory_order_acq_rel)) continue;
    answered_ = frame;
    // Only the last answer wakes the service: one wake in each tick instead of one for each agent.
    if (count > 1) return;
  }
  answered_ = frame;
  answers().wakes.fetch_add(1, std::memory_order_release);
  FutexWake(answers().wakes);
}

}  // namespace troupe
