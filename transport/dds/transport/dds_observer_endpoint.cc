#include "transport/dds/transport/dds_observer_endpoint.h"

#include <memory>
#include <utility>

#include "common/base/identity.h"

namespace troupe::dds {
namespace {

// Waking for each frame is most of the cost of an observer: ten of them would use a fifth of the processor time of 100
// agents that only answer. So an observer wakes at most once in kGatherTime. Frames that follow each other within
// kSameBurst were read without waiting. Long frames are read at once, because a socket's buffer has room for few of
// them.
constexpr std::chrono::milliseconds kGatherTime(20);
constexpr std::chrono::microseconds kSameBurst(100);
constexpr std::size_t kShortFrameRows = 500;

std::size_t RowsOf(const WorldState& state) {
  std::size_t rows = 0;
  ForEachTable([&](const auto& table) { rows += table.Of(state).size(); });
  return rows;
}

}  // namespace

DdsObserverEndpoint::DdsObserverEndpoint(const DdsConnection& connection)
    : requests_(connection, topics::kFrameRequest, qos_profiles::FrameRequest()),
      sessions_(connection, topics::kSession, qos_profiles::FromMany(qos_profiles::Description())),
      statuses_(connection, topics::kStatus, qos_profiles::FromMany(qos_profiles::Status())),
      frames_(connection, topics::kFrame, qos_profiles::ObservedFrame()),
      whole_frames_(connection, topics::kWholeFrame, qos_profiles::ReceivedFrame()),
      id_(MakeRandomId()),
      services_(connection.proves()) {}

DdsObserverEndpoint::~DdsObserverEndpoint() {
  {
    const std::lock_guard lock(gather_mutex_);
    closing_ = true;
  }
  closing_changed_.notify_all();
  sessions_.Close();
  statuses_.Close();
  frames_.Close();
  whole_frames_.Close();
  if (queue_) queue_->Close();  // while the handler may still call this endpoint
}

void DdsObserverEndpoint::Start(ObserverHandler& handler) {
  TROUPE_CHECK(!queue_.has_value());
  const auto request_if_behind = [this] {
    const std::lock_guard lock(mutex_);
    if (protocol_.IsBehind()) RequestWholeFrame();
  };
  queue_.emplace(handler, request_if_behind, ObserverProtocol::kRequestPeriod);
  sessions_.Listen([this] { DrainSessions(); });
  statuses_.Listen([this] { DrainStatuses(); });
  frames_.Listen([this] { GatherFrames(); });
  whole_frames_.Listen([this] { DrainFrames(); });
  DrainSessions();
  DrainStatuses();
  DrainFrames();
}

void DdsObserverEndpoint::RequestFrame() {
  const std::lock_guard lock(mutex_);
  protocol_.AskAgain();
  RequestWholeFrame();
}

void DdsObserverEndpoint::DrainSessions() {
  const std::lock_guard lock(mutex_);
  sessions_.Drain(
      [this](const troupe_wire_Session& session, const Sender& sender) {
        if (!services_.Admits(sessions_, session.run, session.incarnation, sender)) return false;
        if (session.ended) EndRunsOf(sender);
        return !session.ended;
      },
      [this](const SessionMessage& session, const Sender&) {
        protocol_.OnSession(session.run, session.world_edition);
        queue_->PostSession(std::make_shared<const SessionMessage>(session));
      },
      [this](const Sender& ended) { EndRunsOf(ended); });
  sessions_.Clear();  // a world may be large, and is seldom received
  PostFrame();
}

// The last frame may wait still, to be gathered.
void DdsObserverEndpoint::EndRunsOf(const Sender& service) {
  ReadFrames();
  for (const RunId run : services_.Forget(service.participant)) {
    if (protocol_.OnEnd(run)) queue_->PostServiceGone();
  }
}

void DdsObserverEndpoint::DrainStatuses() {
  const std::lock_guard lock(mutex_);
  statuses_.Drain(
      [this](const troupe_wire_Status& status, const Sender& sender) {
        return services_.Admits(statuses_, status.run, status.incarnation, sender);
      },
      [this](const StatusMessage& status, const Sender&) {
        protocol_.OnStatus(status);
        queue_->PostStatus(std::make_shared<const StatusMessage>(status));
      });
}

void DdsObserverEndpoint::GatherFrames() {
  {
    std::unique_lock lock(gather_mutex_);
    if (frames_are_short_ && Clock::now() > last_read_ + kSameBurst) {
      closing_changed_.wait_for(lock, kGatherTime, [this] { return closing_; });
    }
  }
  DrainFrames();
  const std::lock_guard lock(gather_mutex_);
  last_read_ = Clock::now();
}

void DdsObserverEndpoint::ReadFrame(WireInbox<troupe_wire_Frame>& inbox, Read read, const troupe_wire_Frame& frame,
                                    const Sender& sender) {
  if (!services_.Admits(inbox, frame.run, frame.incarnation, sender)) return;
  if (Status malformed = (protocol_.*read)(frame); !malformed.ok()) inbox.ReportMalformed(malformed.error());
  PostFrame();
}

void DdsObserverEndpoint::DrainFrames() {
  const std::lock_guard lock(mutex_);
  ReadFrames();
}

void DdsObserverEndpoint::ReadFrames() {
  const auto ignore_end = [](const Sender&) {};
  // In this order: a whole frame that is found below was sent before any frame that is not found here.
  frames_.Drain([this](const troupe_wire_Frame& frame,
                       const Sender& sender) { ReadFrame(frames_, &ObserverProtocol::OnFrame, frame, sender); },
                ignore_end);
  whole_frames_.Drain(
      [this](const troupe_wire_Frame& frame, const Sender& sender) {
        ReadFrame(whole_frames_, &ObserverProtocol::OnWholeFrame, frame, sender);
      },
      ignore_end);
  if (protocol_.has_gap()) RequestWholeFrame();
}

void DdsObserverEndpoint::PostFrame() {
  const FrameMessage* frame = protocol_.Next();
  if (frame == nullptr) return;
  frames_are_short_ = RowsOf(frame->state) <= kShortFrameRows;
  queue_->PostFrame(std::make_shared<const FrameMessage>(*frame));
}

void DdsObserverEndpoint::RequestWholeFrame() {
  const double now = std::chrono::duration<double>(Clock::now().time_since_epoch()).count();
  if (protocol_.MayRequest(now)) requests_.Send(FrameRequest{id_});
}

bool ObserverProtocol::OnEnd(RunId run) {
  if (world_editions_.erase(run) == 0) return false;
  if (follower_.known() && follower_.frame().run == run) follower_.Reset();
  return world_editions_.empty();
}

Status ObserverProtocol::OnFrame(const troupe_wire_Frame& frame) {
  return follower_.Read(frame);
}

Status ObserverProtocol::OnWholeFrame(const troupe_wire_Frame& frame) {
  requested_at_.reset();
  Status malformed = follower_.Read(frame);
  if (std::exchange(again_, false)) returned_.reset();
  return malformed;
}

const FrameMessage* ObserverProtocol::Next() {
  if (!follower_.known()) return nullptr;
  const FrameMessage& frame = follower_.frame();
  const auto world = world_editions_.find(frame.run);
  if (world == world_editions_.end() || world->second != frame.world_edition) return nullptr;
  // The content of a resent frame that an observer can see: without these, each resend would be shown as a new frame.
  const FrameKey key(frame.run, frame.edition, frame.state.tick, frame.paused && !frame.holds, frame.last);
  if (returned_ == key) return nullptr;
  returned_ = key;
  return &frame;
}

bool ObserverProtocol::IsBehind() const {
  if (follower_.has_gap() || !follower_.known()) return true;
  const FrameMessage& frame = follower_.frame();
  if (!world_editions_.contains(frame.run)) return true;
  return status_ && status_->run == frame.run &&
         std::tie(status_->edition, status_->tick) > std::tie(frame.edition, frame.state.tick);
}

bool ObserverProtocol::MayRequest(double now) {
  if (world_editions_.empty()) return false;
  // The service answers several requests by one frame: more requests would only be traffic.
  if (requested_at_ && now < *requested_at_ + kRequestPeriod) return false;
  requested_at_ = now;
  return true;
}

Status FrameFollower::Read(const troupe_wire_Frame& wire) {
  if (known_ && wire.run == frame_.run) {
    const auto known = std::tie(frame_.edition, frame_.state.tick);
    const auto next = std::tie(wire.edition, wire.tick);
    // A whole frame of the same tick counts: it may have `paused` or `last` set, or answer a request.
    if (next < known || (next == known && !wire.whole)) return {};
  }
  if (!CanRead(wire, frame_) || (!wire.whole && !known_)) {
    has_gap_ = true;
    return {};
  }
  Status malformed = FromWire(wire, frame_);
  known_ = malformed.ok();
  has_gap_ = !known_;
  return malformed;
}

}  // namespace troupe::dds
