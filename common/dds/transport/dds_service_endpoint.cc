#include "common/dds/transport/dds_service_endpoint.h"

#include <algorithm>
#include <utility>

#include "common/dds/transport/topics.h"

namespace troupe::dds {
namespace {

using Clock = std::chrono::steady_clock;

// Ticks between whole frames, for listeners that send no requests.
constexpr Tick kWholePeriod = 100;

// A frame is sent to the observers as a whole at most once in this time. An observer that has not received it resends
// its request later than that.
constexpr std::chrono::milliseconds kWholeFrameInterval(20);

bool HaveSameSizes(const WorldState& a, const WorldState& b) {
  return a.robots.size() == b.robots.size() && a.joints.size() == b.joints.size() &&
         a.grippers.size() == b.grippers.size() && a.objects.size() == b.objects.size();
}

}  // namespace

DdsServiceEndpoint::DdsServiceEndpoint(const DdsConnection& connection)
    : sessions_(connection, topics::kSession, qos_profiles::Description(connection.lease_seconds)),
      admissions_(connection, topics::kAdmission, qos_profiles::Admission()),
      frames_(connection, topics::kFrame, qos_profiles::Frame()),
      whole_frames_(connection, topics::kWholeFrame, qos_profiles::WholeFrame()),
      statuses_(connection, topics::kStatus, qos_profiles::Status()),
      control_replies_(connection, topics::kControlReply, qos_profiles::ControlReply()),
      joins_(connection, topics::kJoin, qos_profiles::Join()),
      proposals_(connection, topics::kProposal, qos_profiles::Proposal()),
      controls_(connection, topics::kControl, qos_profiles::Control()),
      frame_requests_(connection, topics::kFrameRequest, qos_profiles::FrameRequest()),
      rivals_(connection, topics::kSession, qos_profiles::Description() << IgnoreLocal::Participant()) {}

DdsServiceEndpoint::~DdsServiceEndpoint() {
  joins_.Close();
  proposals_.Close();
  controls_.Close();
  frame_requests_.Close();
  rivals_.Close();
}

void DdsServiceEndpoint::Start(ServiceHandler& handler) {
  {
    const std::lock_guard lock(mutex_);
    TROUPE_CHECK(handler_ == nullptr);
    handler_ = &handler;
  }
  joins_.Listen([this] { DrainJoins(); });
  proposals_.Listen([this] { DrainProposals(); });
  controls_.Listen([this] { DrainControls(); });
  frame_requests_.Listen([this] { DrainFrameRequests(); });
  rivals_.Listen([this] { DrainSessions(); });
  DrainSessions();
  DrainJoins();
  DrainProposals();
  DrainControls();
  DrainFrameRequests();
}

void DdsServiceEndpoint::DrainJoins() {
  const std::lock_guard lock(mutex_);
  joins_.Drain(
      [this](const JoinMessage& join) {
        agents_.insert(join.agent);
        handler_->OnJoin(join);
      },
      [this](const troupe_wire_Join& ended) {
        if (agents_.erase(ended.agent) > 0) handler_->OnAgentGone(ended.agent);
      });
}

void DdsServiceEndpoint::DrainProposals() {
  const std::lock_guard lock(mutex_);
  proposals_.Drain([this](const ProposalMessage& proposal) { handler_->OnProposal(proposal); });
}

void DdsServiceEndpoint::DrainControls() {
  const std::lock_guard lock(mutex_);
  controls_.Drain([this](const ControlRequest& request) { handler_->OnControl(request); });
}

void DdsServiceEndpoint::DrainSessions() {
  const std::lock_guard lock(mutex_);
  rivals_.Drain([this](const SessionMessage& session) { handler_->OnRivalService(session); });
  rivals_.Clear();
}

void DdsServiceEndpoint::SendSession(const SessionMessage& session) {
  sessions_.Send(session);
}
void DdsServiceEndpoint::SendAdmissions(const std::vector<AdmissionMessage>& admissions) {
  admissions_.Send(admissions);
}
void DdsServiceEndpoint::DrainFrameRequests() {
  const std::lock_guard lock(frame_mutex_);
  bool requested = false;
  frame_requests_.Drain([&requested](const FrameRequest&) { requested = true; });
  if (!requested || !sent_) return;
  if (sent_whole_at_ && Clock::now() < *sent_whole_at_ + kWholeFrameInterval) return;
  SendWholeFrame();
}

void DdsServiceEndpoint::SendWholeFrame() {
  whole_frames_.Send(*sent_);
  sent_whole_at_ = Clock::now();
}

void DdsServiceEndpoint::SendFrame(const FrameMessage& frame) {
  const std::lock_guard lock(frame_mutex_);
  // Every agent that answered the frame of the tick before has its state. To the others this frame is resent, whole.
  const bool follows = sent_ && frame.run == sent_->run && frame.edition == sent_->edition &&
                       frame.state.tick == sent_->state.tick + 1 && HaveSameSizes(frame.state, sent_->state);
  const bool whole = !follows || frame.paused || frame.last || frame.state.tick % kWholePeriod == 0;
  frames_.Send(frame, whole ? nullptr : &std::as_const(sent_->state));
  sent_ = frame;
  sent_whole_at_.reset();
}
void DdsServiceEndpoint::SendStatus(const StatusMessage& status) {
  statuses_.Send(status);
}

void DdsServiceEndpoint::SendControlReply(const ControlReply& reply) {
  control_replies_.Send(reply);
}

void DdsServiceEndpoint::Flush(double seconds) {
  const auto deadline = Clock::now() + std::chrono::duration<double>(seconds);
  const auto remaining = [&] { return std::max(0.0, std::chrono::duration<double>(deadline - Clock::now()).count()); };
  sessions_.writer().wait_for_acknowledgments(remaining());
  admissions_.writer().wait_for_acknowledgments(remaining());
  control_replies_.writer().wait_for_acknowledgments(remaining());
  frames_.writer().wait_for_acknowledgments(remaining());
}

}  // namespace troupe::dds
