#include "common/dds/transport/dds_observer_endpoint.h"

#include <memory>
#include <utility>

#include "common/base/random_id.h"
#include "common/protocol/topics.h"

namespace troupe::dds {
namespace {

// After this time without an answer a request is resent: it, or the frame, was lost, or the service did not know this
// endpoint yet. Longer than the time for which a service ignores further requests.
constexpr double kRequestPeriod = 0.05;  // s

// Waking for each frame is most of the cost of an observer: ten of them would use a fifth of the processor time of 100
// agents that only answer. So an observer wakes at most once in kGatherTime. Frames that follow each other within
// kSameBurst were read without waiting. Long frames are read at once, because a socket's buffer has room for few of
// them.
constexpr std::chrono::milliseconds kGatherTime(20);
constexpr std::chrono::microseconds kSameBurst(100);
constexpr std::size_t kShortFrameRows = 500;

std::size_t RowsOf(const WorldState& state) {
  return state.robots.size() + state.joints.size() + state.grippers.size() + state.objects.size();
}

}  // namespace

DdsObserverEndpoint::DdsObserverEndpoint(const DdsConnection& connection)
    : requests_(connection, topics::kFrameRequest, qos_profiles::FrameRequest()),
      sessions_(connection, topics::kSession, qos_profiles::FromMany(qos_profiles::Description())),
      statuses_(connection, topics::kStatus, qos_profiles::FromMany(qos_profiles::Status())),
      frames_(connection, topics::kFrame, qos_profiles::ObservedFrame()),
      whole_frames_(connection, topics::kWholeFrame, qos_profiles::ReceivedFrame()),
      id_(MakeRandomId()) {}

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
    if (IsBehind()) RequestWholeFrame();
  };
  queue_.emplace(handler, request_if_behind, kRequestPeriod);
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
  post_again_ = true;
  RequestWholeFrame();
}

void DdsObserverEndpoint::DrainSessions() {
  const std::lock_guard lock(mutex_);
  sessions_.Drain(
      [this](const troupe_wire_Session& session, const Sender& sender) {
        if (!services_.Admits(sessions_, session.run, sender)) return false;
        if (session.ended) EndRunsOf(sender);
        return !session.ended;
      },
      [this](const SessionMessage& session, const Sender&) {
        world_editions_[session.run] = session.world_edition;
        queue_->PostSession(std::make_shared<const SessionMessage>(session));
      },
      [this](const Sender& ended) { EndRunsOf(ended); });
  sessions_.Clear();  // a world may be large, and is seldom received
  PostFrame();
}

void DdsObserverEndpoint::EndRunsOf(const Sender& service) {
  for (const RunId run : services_.Forget(service.participant)) EndRun(run);
}

void DdsObserverEndpoint::EndRun(RunId run) {
  if (world_editions_.erase(run) == 0) return;
  if (follower_.known() && follower_.frame().run == run) follower_.Reset();
  if (world_editions_.empty()) queue_->PostServiceGone();
}

void DdsObserverEndpoint::DrainStatuses() {
  const std::lock_guard lock(mutex_);
  statuses_.Drain([this](const troupe_wire_Status& status,
                         const Sender& sender) { return services_.Admits(statuses_, status.run, sender); },
                  [this](const StatusMessage& status, const Sender&) {
                    status_ = status;
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

void DdsObserverEndpoint::ReadFrame(WireInbox<troupe_wire_Frame>& inbox, const troupe_wire_Frame& frame,
                                    const Sender& sender) {
  if (!services_.Admits(inbox, frame.run, sender)) return;
  if (Status malformed = follower_.Read(frame); !malformed.ok()) inbox.ReportMalformed(malformed.error());
}

void DdsObserverEndpoint::DrainFrames() {
  const std::lock_guard lock(mutex_);
  const auto ignore_end = [](const Sender&) {};
  // In this order: a whole frame that is found below was sent before any frame that is not found here.
  frames_.Drain(
      [this](const troupe_wire_Frame& frame, const Sender& sender) {
        ReadFrame(frames_, frame, sender);
        PostFrame();
      },
      ignore_end);
  whole_frames_.Drain(
      [this](const troupe_wire_Frame& frame, const Sender& sender) {
        requested_at_.reset();
        ReadFrame(whole_frames_, frame, sender);
        if (std::exchange(post_again_, false)) posted_.reset();
        PostFrame();
      },
      ignore_end);
  if (follower_.has_gap()) RequestWholeFrame();
}

void DdsObserverEndpoint::PostFrame() {
  if (!follower_.known()) return;
  const FrameMessage& frame = follower_.frame();
  const auto world = world_editions_.find(frame.run);
  if (world == world_editions_.end() || world->second != frame.world_edition) return;
  const FrameKey key(frame.run, frame.edition, frame.state.tick, frame.paused, frame.last);
  if (posted_ == key) return;
  posted_ = key;
  frames_are_short_ = RowsOf(frame.state) <= kShortFrameRows;
  queue_->PostFrame(std::make_shared<const FrameMessage>(frame));
}

bool DdsObserverEndpoint::IsBehind() const {
  if (follower_.has_gap() || !follower_.known()) return true;
  const FrameMessage& frame = follower_.frame();
  if (!world_editions_.contains(frame.run)) return true;
  return status_ && status_->run == frame.run &&
         std::tie(status_->edition, status_->tick) > std::tie(frame.edition, frame.state.tick);
}

void DdsObserverEndpoint::RequestWholeFrame() {
  if (world_editions_.empty()) return;  // without a service
  const auto now = Clock::now();
  if (requested_at_ && now < *requested_at_ + std::chrono::duration<double>(kRequestPeriod)) return;
  requested_at_ = now;
  requests_.Send(FrameRequest{id_});
}

}  // namespace troupe::dds
