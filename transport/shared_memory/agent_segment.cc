#include "transport/shared_memory/agent_segment.h"

#include <algorithm>
#include <chrono>
#include <thread>
#include <utility>

#include "common/base/identity.h"

namespace troupe {
namespace {

constexpr double kMaxSleep = 10.0;  // s
constexpr std::uint64_t kGroups = 32;

// The first pin that no agent has claimed, from number `first` modulo their count on.
std::optional<std::size_t> ClaimPin(const SharedMemory& answers, std::size_t first) {
  for (std::size_t i = 0; i < kPins; ++i) {
    const std::size_t pin = (first + i) % kPins;
    const Result<bool> claimed = answers.Claim(PinOffset(pin), sizeof(Pin));
    if (!claimed.ok()) return std::nullopt;
    if (claimed.value()) return pin;
  }
  return std::nullopt;
}

}  // namespace

Result<std::unique_ptr<AgentSegment>> AgentSegment::Open(const SharingAddress& address) {
  if (address.machine != ThisMachine()) return Failure("it is of another user or container");
  auto memory = SharedMemory::Open(address.process, address.frames, kPlaceBytes, SharedMemory::Peers::kMayRead);
  if (!memory.ok()) return memory.error();
  std::uint64_t place = 0;
  {
    auto header = memory.value().Map(0, kFramesHeaderBytes);
    if (!header.ok()) return header.error();
    const FramesHeader& found = header.value().At<FramesHeader>(0);
    // The number of a descriptor may have been used again since the announcement.
    if (found.key != address.key || found.layout != SharedLayout()) {
      return Failure("the memory of process " + std::to_string(address.process) + " is of another run or version");
    }
    place = found.place;
  }
  auto frames = Attach(memory.value(), place, kPlaceBytes, Attachment::kReadOnly);
  if (!frames.ok()) return frames.error();
  auto answers = SharedMemory::Open(address.process, address.answers, kAnswersBytes, SharedMemory::Peers::kMayWrite);
  if (!answers.ok()) return answers.error();
  auto header = answers.value().Map(0, kAnswersHeaderBytes);
  if (!header.ok()) return header.error();
  const std::optional<std::size_t> pin =
      ClaimPin(answers.value(), header.value().At<AnswersHeader>(0).openings.fetch_add(1));
  if (!pin) return Failure("it has no place for another agent");
  return std::unique_ptr<AgentSegment>(new AgentSegment(address.process, std::move(frames).value(),
                                                        std::move(answers).value(), std::move(header).value(), *pin));
}

AgentSegment::AgentSegment(pid_t service, std::shared_ptr<const MappedMemory> frames, SharedMemory answers,
                           MappedMemory header, std::size_t pin)
    : service_(service),
      frames_(std::move(frames)),
      answers_(std::move(answers)),
      answers_header_(std::move(header)),
      pin_(pin),
      group_(std::uint32_t{1} << (MakeRandomId() % kGroups)) {
  SetPin(0);  // of its last owner
}

AgentSegment::~AgentSegment() {
  SetPin(0);
}

void AgentSegment::SetPin(std::uint64_t newest) {
  if (pinned_ != 0) EndAccess(&FrameOf(pinned_));
  pinned_ = newest;
  answers_header_.At<Pin>(PinOffset(pin_)).frame.store(newest);
}

bool AgentSegment::Wait() {
  waiting_ = true;
  const std::uint32_t awaited = awaited_;
  while (!closing_ && frames().published.load(std::memory_order_acquire) == awaited) {
    FutexWait(frames().published, awaited, kMaxSleep, group_);
  }
  // Before the news are read: what is published meanwhile wakes the next call.
  awaited_ = frames().published.load(std::memory_order_acquire);
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

AgentSegment::Outcome AgentSegment::ReadSession(SessionMessage& session, PreparedWorld& prepared, Status& reason) {
  if (closing_) return Outcome::kNothing;
  if (end() == SharingEnd::kNetwork) return Outcome::kNetwork;
  SharedSession shared;
  bool is_read = false;
  const bool is_new = ReadNewer(frames().session, frames().session_words, session_,
                                [&](WordReader words) { is_read = words.Read(shared) && words.remaining() == 0; });
  if (!is_new) return Outcome::kNothing;
  Result<PreparedWorld> attached =
      is_read ? AttachWorld(service_, shared.image) : Failure("it has a session with a value that is not known");
  if (!attached.ok()) {
    reason = attached.error();
    return Outcome::kNetwork;
  }
  prepared = std::move(attached).value();
  session = SessionMessage{.run = shared.run,
                           .protocol_version = shared.protocol_version,
                           .host = std::move(shared.host),
                           .pid = shared.pid,
                           .lease_seconds = shared.lease_seconds,
                           .begun = shared.begun,
                           .world = WorldOf(prepared.scene),
                           .world_edition = shared.world_edition,
                           .incarnation = shared.incarnation};
  return Outcome::kNews;
}

AgentSegment::Outcome AgentSegment::Read(const FrameInPlace*& frame) {
  for (;;) {
    if (closing_) return Outcome::kNothing;
    // Before the newest frame: of a run that is over, that one is then the last.
    const SharingEnd ended = end();
    if (ended == SharingEnd::kNetwork) return Outcome::kNetwork;
    const std::uint64_t newest = frames().newest.load(std::memory_order_acquire);
    if (FrameIn(newest) == read_) return ended == SharingEnd::kRunOver ? Outcome::kRunOver : Outcome::kNothing;
    // In this order (sequentially consistent): see Pin.
    SetPin(newest);
    if (frames().newest.load() != newest) continue;
    read_ = FrameIn(newest);
    frame = &FrameOf(newest);
    return Outcome::kNews;
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
