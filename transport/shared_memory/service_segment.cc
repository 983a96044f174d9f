#include "transport/shared_memory/service_segment.h"

#include <unistd.h>

#include <algorithm>
#include <new>
#include <thread>
#include <utility>

#include "common/base/identity.h"

namespace troupe {
namespace {

// s. The service looks for answers after twice the usual time, and then less and less often.
constexpr double kMinWait = 0.001;
constexpr double kMaxWait = 0.05;
constexpr double kIdleWait = 0.5;  // without agents
constexpr double kLearningRate = 0.1;

}  // namespace

Result<std::unique_ptr<ServiceSegment>> ServiceSegment::Create() {
  SharingAddress address;
  address.machine = ThisMachine();
  if (address.machine.empty()) return Failure("the system does not tell its boot and namespaces");
  auto frames = PlacedMemory::Create("troupe-frames");
  if (!frames.ok()) return frames.error();
  auto answers = SharedMemory::Create("troupe-answers", kAnswersBytes, SharedMemory::Peers::kMayWrite);
  if (!answers.ok()) return answers.error();
  if (Status status = frames.value().memory.Reserve(0, kFramesHeaderBytes); !status.ok()) return status.error();
  if (Status status = answers.value().memory.Reserve(0, kAnswersHeaderBytes); !status.ok()) return status.error();
  if (Result<bool> claimed = answers.value().memory.IsClaimed(0, kPage); !claimed.ok()) return claimed.error();
  address.process = getpid();
  address.frames = frames.value().memory.descriptor();
  address.answers = answers.value().memory.descriptor();
  address.key = MakeRandomId();
  return std::unique_ptr<ServiceSegment>(
      new ServiceSegment(std::move(frames).value(), std::move(answers).value(), address));
}

ServiceSegment::ServiceSegment(PlacedMemory frames, SharedMemory::OwnedMemory answers, const SharingAddress& address)
    : frames_(std::move(frames)), answers_(std::move(answers)), address_(address) {
  this->frames().key = address_.key;
  this->frames().place = reinterpret_cast<std::uintptr_t>(frames_.begin);
  this->frames().layout = SharedLayout();
}

void ServiceSegment::Bind(AgentId agent) {
  const std::lock_guard lock(mutex_);
  if (agent == 0 || slot_of_.contains(agent)) return;
  std::size_t index = 0;
  while (index < kSlots && !IsFree(index)) ++index;
  // More agents than slots: the others use the network.
  if (index == kSlots) return;
  if (index >= slots_.size()) slots_.resize(index + 1);
  // A message of the slot's last agent is not one of this agent; the seqlock continues.
  slots_[index].agent = agent;
  slots_[index].round = 0;
  slot_of_[agent] = index;
  frames().agents[index] = agent;
}

bool ServiceSegment::IsFree(std::size_t slot) {
  if (slot < slots_.size() && slots_[slot].agent != 0) return false;
  const Result<bool> claimed = answers_.memory.IsClaimed(SlotOffset(slot), kSlotBytes);
  const bool is_free = claimed.ok() && !claimed.value();
  frames().agents[slot] = is_free ? 0 : kClaimed;
  return is_free;
}

void ServiceSegment::Unbind(AgentId agent) {
  const std::lock_guard lock(mutex_);
  const auto known = slot_of_.find(agent);
  if (known == slot_of_.end()) return;
  frames().agents[known->second] = 0;
  slots_[known->second].agent = 0;
  slot_of_.erase(known);
}

// Agents that answered the previous frame are expected to answer this one: a silent agent costs its time once.
std::uint32_t ServiceSegment::CountExpected(const FrameMessage& frame) const {
  std::uint32_t count = 0;
  if (frame.awaited.empty()) {
    for (const Slot& slot : slots_) count += slot.agent != 0 && slot.round == round_ ? 1 : 0;
    return count;
  }
  for (const AgentId agent : frame.awaited) {
    const auto known = slot_of_.find(agent);
    count += known != slot_of_.end() && slots_[known->second].round != 0 ? 1 : 0;
  }
  return count;
}

Status ServiceSegment::PublishSession(const SessionMessage& session) {
  const std::lock_guard lock(mutex_);
  if (ended_) return {};
  // The same description is announced again when the run begins.
  if (image_ == nullptr || &*world_of_image_ != &*session.world) {
    auto made = WorldImage::Make(session.world);
    if (!made.ok()) {
      End(SharingEnd::kNetwork);
      return made.error();
    }
    // Agents that still use the previous one have its memory mapped.
    image_ = std::move(made).value();
    world_of_image_ = session.world;
  }
  edition_of_image_ = session.world_edition;
  SeqlockWriter writer(frames().session, frames().session_words);
  writer.words().Add(SharedSession{session.run, session.protocol_version, session.host, session.pid,
                                   session.lease_seconds, session.begun, session.world_edition, session.incarnation,
                                   image_->place()});
  if (!writer.Finish()) {
    End(SharingEnd::kNetwork);
    return Failure("the name of the host is too long for shared memory");
  }
  Announce();
  return {};
}

std::optional<std::size_t> ServiceSegment::FindFreeBuffer() {
  std::array<bool, kBuffers> is_read{};
  const std::uint64_t newest = frames().newest.load();
  if (newest != 0) is_read[BufferIn(newest)] = true;
  // Agents write the number; it must not become less.
  pins_ = std::max(pins_, std::min<std::size_t>(answers().openings.load(), kPins));
  for (std::size_t i = 0; i < pins_; ++i) {
    Word& pin = answers_.mapped.At<Pin>(PinOffset(i)).frame;
    // Sequentially consistent, as the publication of the newest frame before: see Pin.
    const std::uint64_t pinned = pin.load();
    const std::size_t buffer = BufferIn(pinned);
    if (pinned == 0 || buffer >= kBuffers || buffers_[buffer].content != pinned || is_read[buffer]) continue;
    // An agent that is behind: it may have ended.
    if (FrameIn(pinned) + 1 < FrameIn(newest)) {
      const Result<bool> claimed = answers_.memory.IsClaimed(PinOffset(i), sizeof(Pin));
      if (claimed.ok() && !claimed.value()) {
        pin.store(0);
        continue;
      }
    }
    is_read[buffer] = true;
  }
  const auto free = std::find(is_read.begin(), is_read.end(), false);
  if (free == is_read.end()) return std::nullopt;
  return static_cast<std::size_t>(free - is_read.begin());
}

bool ServiceSegment::BelongsToImage(const FrameMessage& frame) const {
  return image_ != nullptr && frame.world_edition == edition_of_image_ && image_->scene().CheckState(frame.state).ok();
}

void ServiceSegment::Fill(Buffer& buffer, std::size_t index, const FrameMessage& frame) {
  // Once for all agents.
  const bool is_checked = BelongsToImage(frame);
  if (buffer.arena == nullptr) {
    buffer.arena = std::make_unique<SharedArena>(frames_, BufferOffset(index), kBufferBytes);
  }
  const SharedArena::Scope scope(*buffer.arena);
  if (buffer.frame == nullptr) buffer.frame = new FrameInPlace;  // the first object of the buffer
  BeginAccess(buffer.frame);
  buffer.frame->message = frame;
  buffer.frame->is_checked = is_checked;
}

Status ServiceSegment::Publish(const FrameMessage& frame) {
  const std::lock_guard lock(mutex_);
  if (ended_) return {};
  const std::optional<std::size_t> free = FindFreeBuffer();
  if (!free) {
    End(SharingEnd::kNetwork);
    return Failure("stopped agents read all frames in shared memory");
  }
  Buffer& buffer = buffers_[*free];
  buffer.content = 0;
  try {
    Fill(buffer, *free, frame);
  } catch (const std::bad_alloc&) {
    End(SharingEnd::kNetwork);
    return Failure("a frame is too long for shared memory, or the system has none");
  }
  missing_ = CountExpected(frame);
  if (frame.awaited.empty()) ++round_;
  ++published_;
  published_at_ = Clock::now();
  buffer.content = Newest(published_, *free);
  // Before the frame is visible: its first answer may come at once.
  answers().missing.store(Missing(published_, missing_), std::memory_order_release);
  frames().newest.store(buffer.content);
  Announce();
  if (waiting_) Wake();  // for as long as is right for this frame
  return {};
}

void ServiceSegment::Announce() {
  frames().published.fetch_add(1, std::memory_order_release);
  FutexWake(frames().published);
}

void ServiceSegment::Wake() {
  answers().wakes.fetch_add(1, std::memory_order_release);
  FutexWake(answers().wakes);
}

void ServiceSegment::End(SharingEnd end) {
  ended_ = true;
  frames().end.store(static_cast<std::uint64_t>(end), std::memory_order_release);
  Announce();
}

void ServiceSegment::EndRun() {
  const std::lock_guard lock(mutex_);
  if (!ended_) End(SharingEnd::kRunOver);
}

double ServiceSegment::LongestWait() const {
  const std::lock_guard lock(mutex_);
  // Nothing is expected through this memory.
  if (missing_ == 0) return slot_of_.empty() ? kIdleWait : kMaxWait;
  const double elapsed = std::chrono::duration<double>(Clock::now() - published_at_).count();
  // Patient at first, then at intervals that grow with the time waited: the wake by the last agent is the rule, and
  // this is for counts that are wrong.
  const double first = 2.0 * usual_seconds_ - elapsed;
  return std::clamp(first > 0.0 ? first : elapsed / 2.0, kMinWait, kMaxWait);
}

bool ServiceSegment::Wait() {
  waiting_ = true;
  if (!closing_ && answers().wakes.load(std::memory_order_acquire) == seen_wakes_) {
    FutexWait(answers().wakes, seen_wakes_, LongestWait());
  }
  waiting_ = false;
  seen_wakes_ = answers().wakes.load(std::memory_order_acquire);
  return !closing_;
}

void ServiceSegment::Close() {
  closing_ = true;
  while (waiting_) {
    Wake();
    std::this_thread::yield();
  }
}

bool ServiceSegment::Read(Slot& slot, std::size_t index, SharedAnswer& answer) const {
  const MappedMemory& memory = answers_.mapped;
  const SlotHeader& header = memory.At<SlotHeader>(SlotOffset(index));
  const auto words = memory.Array<const Word>(SlotOffset(index) + sizeof(SlotHeader), kSlotWords);
  return ReadNewer(header.message, words, slot.seen, [&](const WordReader& reader) {
    answer.agent = slot.agent;
    answer.sent_at = header.sent_at.load(std::memory_order_acquire);
    answer.malformed = ReadProposal(reader, answer.proposal);
    if (answer.malformed.ok() && answer.proposal.agent != slot.agent) {
      answer.malformed = Error{{}, "a proposal in shared memory in the name of another agent"};
    }
  });
}

std::span<const SharedAnswer> ServiceSegment::Collect() {
  const std::lock_guard lock(mutex_);
  std::size_t count = 0;
  for (std::size_t i = 0; i < slots_.size(); ++i) {
    Slot& slot = slots_[i];
    if (slot.agent == 0) continue;
    if (count == collected_.size()) collected_.emplace_back();
    if (!Read(slot, i, collected_[count])) continue;
    ++count;
    if (slot.round != 0 && missing_ > 0 && --missing_ == 0) {
      const double seconds = std::chrono::duration<double>(Clock::now() - published_at_).count();
      usual_seconds_ += kLearningRate * (seconds - usual_seconds_);
    }
    slot.round = round_;
  }
  std::stable_sort(collected_.begin(), collected_.begin() + static_cast<std::ptrdiff_t>(count),
                   [](const SharedAnswer& a, const SharedAnswer& b) { return a.sent_at < b.sent_at; });
  return {collected_.data(), count};
}

}  // namespace troupe
