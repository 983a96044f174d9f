#include "transport/dds/transport/dds_observer_endpoint.h"

#include <memory>
#include <utility>

#include "common/base/random_id.h"
#include "transport/protocol/topics.h"

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
  return state.robots.size() + state.joints.size() + state.grippers.size() + state.objects.size() +
         state.transmissions.size();
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

}  // namespace troupe::dds
