#include "transport/dds/transport/dds_service_endpoint.h"

#include <chrono>
#include <new>
#include <utility>

#include "common/model/states.h"
#include "transport/protocol/message_texts.h"

namespace troupe::dds {
namespace {

// s, for which all readers together may acknowledge the last samples. A viewer has a low priority: on a busy machine it
// may be a second behind. A reader that was killed does not acknowledge, until its lease expires.
constexpr double kMaxEndWait = 5.0;

using Clock = std::chrono::steady_clock;

// Agents that may join through one writer: an agent that rejoins as another one is a new agent.
constexpr std::size_t kAgentsOfWriter = 64;

std::unique_ptr<ServiceSegment> MakeSegment(const DdsConnection& connection, bool data_sharing) {
  if (!data_sharing) return nullptr;
  Result<std::unique_ptr<ServiceSegment>> segment = ServiceSegment::Create();
  if (segment.ok()) return std::move(segment).value();
  connection.Report("no data sharing: " + segment.error().message);
  return nullptr;
}

std::vector<std::unique_ptr<AgentGroup>> MakeGroups(const std::vector<const DdsConnection*>& connections,
                                                    const ServiceSegment* segment) {
  std::vector<std::unique_ptr<AgentGroup>> groups;
  const std::string sharing = segment != nullptr ? ToText(segment->address()) : std::string();
  for (const DdsConnection* connection : connections) {
    groups.push_back(std::make_unique<AgentGroup>(*connection, sharing));
  }
  return groups;
}

// Ticks between whole frames, for listeners that send no requests.
constexpr Tick kKeyframePeriod = 100;

// A frame is sent to the observers as a whole at most once in this time (s). An observer that has not received it
// resends its request later than that.
constexpr double kWholeFrameInterval = 0.02;

}  // namespace

DdsServiceEndpoint::DdsServiceEndpoint(const std::vector<const DdsConnection*>& connections, bool data_sharing)
    : connection_(*connections.front()),
      segment_(MakeSegment(connection_, data_sharing)),
      groups_(MakeGroups(connections, segment_.get())),
      whole_frames_(connection_, topics::kWholeFrame, qos_profiles::WholeFrame()),
      statuses_(connection_, topics::kStatus, qos_profiles::Status()),
      control_replies_(connection_, topics::kControlReply, qos_profiles::ControlReply()),
      controls_(connection_, topics::kControl, qos_profiles::FromMany(qos_profiles::Control())),
      frame_requests_(connection_, topics::kFrameRequest, qos_profiles::FromMany(qos_profiles::FrameRequest())),
      rivals_(connection_, topics::kSession,
              qos_profiles::FromMany(qos_profiles::Description()) << IgnoreLocal::Participant()),
      secured_(connection_.secured),
      proven_(connection_.proves()) {}

DdsServiceEndpoint::~DdsServiceEndpoint() {
  for (const auto& group : groups_) {
    group->joins.Close();
    group->proposals.Close();
  }
  controls_.Close();
  frame_requests_.Close();
  rivals_.Close();
  if (collector_.joinable()) {
    segment_->Close();
    collector_.join();
  }
  // Agents learn at once that the service has ended in order, through the memory that they share or by the last
  // session; else they would wait for its lease.
  if (segment_ && run_ != 0) segment_->EndRun();
  troupe_wire_Session last{};
  last.run = run_;
  last.ended = true;
  for (const auto& group : groups_) {
    if (run_ != 0) group->sessions.SendWire(last);
  }
  // One deadline for all groups.
  const auto end = Clock::now() + std::chrono::duration<double>(kMaxEndWait);
  for (const auto& group : groups_) {
    group->connection.publisher.AwaitAcknowledgments(std::chrono::duration<double>(end - Clock::now()).count());
  }
}

void DdsServiceEndpoint::Start(ServiceHandler& handler) {
  {
    const std::lock_guard lock(mutex_);
    TROUPE_CHECK(handler_ == nullptr);
    handler_ = &handler;
  }
  for (const auto& owned : groups_) {
    AgentGroup& group = *owned;
    group.joins.Listen([this, &group] { Deliver([this, &group] { DrainJoins(group); }); });
    group.proposals.Listen([this, &group] { Deliver([this, &group] { DrainProposals(group); }); });
  }
  controls_.Listen([this] { Deliver([this] { DrainControls(); }); });
  frame_requests_.Listen([this] { Deliver([this] { DrainFrameRequests(); }); });
  rivals_.Listen([this] { Deliver([this] { DrainSessions(); }); });
  // Samples that arrived before the listeners were set.
  DrainSessions();
  for (const auto& group : groups_) {
    DrainJoins(*group);
    DrainProposals(*group);
  }
  DrainControls();
  DrainFrameRequests();
  if (segment_) collector_ = std::thread([this] { CollectAnswers(); });
}

void DdsServiceEndpoint::CollectAnswers() {
  while (segment_->Wait()) {
    Deliver([this] { DrainAnswers(); });
  }
}

void DdsServiceEndpoint::DrainAnswers() {
  const std::lock_guard lock(mutex_);
  for (const SharedAnswer& answer : segment_->Collect()) {
    if (answer.malformed.ok()) {
      handler_->OnProposal(answer.proposal);
    } else {
      groups_.front()->proposals.ReportMalformed(answer.malformed.error());
    }
  }
}

void DdsServiceEndpoint::Deliver(const std::function<void()>& drain) {
  try {
    drain();
  } catch (const std::bad_alloc&) {
    const std::lock_guard lock(mutex_);
    handler_->OnOutOfMemory();
  }
}

void DdsServiceEndpoint::DrainJoins(AgentGroup& group) {
  const std::lock_guard lock(mutex_);
  group.joins.Drain(
      [this, &group](const troupe_wire_Join& join, const Sender& sender) {
        if (join.leaving) {
          Leave(join.agent, sender);
          return false;
        }
        if (!MayJoinFor(join, sender)) {
          group.joins.Refuse(sender, "its keys are those of an agent of other robots");
          return false;
        }
        if (Bind(join.agent, sender)) return true;
        group.joins.Refuse(sender, "it joins as the agent of another participant, or as more than 64 agents");
        return false;
      },
      [this](const JoinMessage& join, const Sender&) { handler_->OnJoin(join); },
      [this](const Sender& ended) { LoseAgentsOf(ended); });
}

bool DdsServiceEndpoint::Bind(AgentId agent, const Sender& sender) {
  const auto known = agents_.find(agent);
  if (known != agents_.end() && known->second.writer == sender.writer) return true;
  if (known != agents_.end() && known->second.participant != sender.participant) return false;
  std::set<AgentId>& of_writer = agents_of_writer_[sender.writer];
  if (of_writer.size() >= kAgentsOfWriter) return false;
  // A writer that is discovered again after its lease has another handle, and its samples may come before the notice of
  // the end of the first one: which then ends no agent.
  if (known != agents_.end()) agents_of_writer_[known->second.writer].erase(agent);
  of_writer.insert(agent);
  agents_.insert_or_assign(agent, sender);
  lost_agents_.Remove(agent);
  if (segment_) segment_->Bind(agent);
  return true;
}

bool DdsServiceEndpoint::MayJoinFor(const troupe_wire_Join& join, const Sender& sender) const {
  if (!secured_) return true;
  const std::vector<std::string> robots = Strings(join.robots);
  const std::vector<std::string> of_process = Strings(join.process_robots);
  // The permissions of its keys have the name, which is a hash of the robots' names (message_texts.h), and so has the
  // partition, which DDS Security has compared with them. After an edit the agent joins for some of these robots.
  const std::string name = qos_profiles::AgentOfPartition(sender.partition);
  if (of_process.empty()) return AgentName(robots) == name;
  const std::set<std::string> allowed(of_process.begin(), of_process.end());
  return AgentName(of_process) == name &&
         std::all_of(robots.begin(), robots.end(), [&](const std::string& robot) { return allowed.contains(robot); });
}

void DdsServiceEndpoint::Leave(AgentId agent, const Sender& sender) {
  const auto known = agents_.find(agent);
  if (known == agents_.end() || known->second.participant != sender.participant) return;
  agents_of_writer_[known->second.writer].erase(agent);
  agents_.erase(known);
  if (segment_) segment_->Unbind(agent);
  handler_->OnAgentGone(agent);
}

void DdsServiceEndpoint::LoseAgentsOf(const Sender& ended) {
  // The lease of the writer has expired: all agents of the process are gone, unless they join again.
  const auto lost = agents_of_writer_.extract(ended.writer);
  if (lost.empty()) return;
  for (const AgentId agent : lost.mapped()) {
    agents_.erase(agent);
    const std::optional<AgentId> forgotten = lost_agents_.Add(agent, ended.participant);
    if (forgotten && segment_) segment_->Unbind(*forgotten);
    handler_->OnAgentSilent(agent);
  }
}

bool DdsServiceEndpoint::IsFromAgent(AgentGroup& group, AgentId agent, const Sender& sender) {
  if (const auto known = agents_.find(agent); known != agents_.end()) {
    if (known->second.participant == sender.participant) return true;
    group.proposals.Refuse(sender, "another participant is this agent");
    return false;
  }
  // A proposal of an agent that was lost for a moment reaches the run, which asks the agent to join again.
  return lost_agents_.Contains(agent, sender.participant);
}

void DdsServiceEndpoint::DrainProposals(AgentGroup& group) {
  const std::lock_guard lock(mutex_);
  group.proposals.Drain([&](const troupe_wire_Proposal& proposal,
                            const Sender& sender) { return IsFromAgent(group, proposal.agent, sender); },
                        [this](const ProposalMessage& proposal, const Sender&) { handler_->OnProposal(proposal); });
}

void DdsServiceEndpoint::DrainControls() {
  const std::lock_guard lock(mutex_);
  controls_.Drain(AdmitAll(), [this](const ControlRequest& request, const Sender&) { handler_->OnControl(request); });
  controls_.Clear();  // a stranger's may be large
}

void DdsServiceEndpoint::DrainSessions() {
  const std::lock_guard lock(mutex_);
  // A stranger cannot end this run by claiming to continue it.
  const RunId own = proven_ ? RunId(0) : RunId(run_);
  rivals_.Drain([own](const troupe_wire_Session& session,
                      const Sender&) { return !session.ended && (own == 0 || session.run != own); },
                [this](const SessionMessage& session, const Sender&) { handler_->OnRivalService(session); });
  rivals_.Clear();
}

void DdsServiceEndpoint::SendSession(const SessionMessage& session) {
  run_ = session.run;
  if (segment_) {
    const Status published = segment_->PublishSession(session);
    if (!published.ok()) connection_.Report("data sharing ends: " + published.error().message);
  }
  for (const auto& group : groups_) group->sessions.Send(session);
}

void DdsServiceEndpoint::SendAdmissions(const std::vector<AdmissionMessage>& admissions) {
  for (const auto& group : groups_) group->admissions.Send(admissions);
}

void DdsServiceEndpoint::DrainFrameRequests() {
  const std::lock_guard lock(frame_mutex_);
  bool requested = false;
  frame_requests_.Drain(AdmitAll(), [&requested](const FrameRequest&, const Sender&) { requested = true; });
  if (!requested) return;
  const double now = std::chrono::duration<double>(Clock::now().time_since_epoch()).count();
  if (const FrameMessage* frame = stream_.AnswerRequest(now)) whole_frames_.Send(*frame);
}

void DdsServiceEndpoint::SendFrame(const FrameMessage& frame) {
  const std::lock_guard lock(frame_mutex_);
  if (segment_) {
    const Status published = segment_->Publish(frame);
    if (!published.ok()) connection_.Report("data sharing ends: " + published.error().message);
  }
  for (const auto& group : groups_) group->SendFrame(frame, stream_.BaseOf(frame));
  stream_.Sent(frame);
}

void DdsServiceEndpoint::SendHistory(const HistoryMessage& history) {
  for (const auto& group : groups_) group->histories.Send(history);
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
  for (const auto& group : groups_) group->Flush(remaining);
  control_replies_.writer().wait_for_acknowledgments(seconds);
}

AgentGroup::AgentGroup(const DdsConnection& connection_of_group, const std::string& sharing)
    : connection(connection_of_group),
      sessions(connection, topics::kSession, qos_profiles::Description(connection.lease_seconds), sharing),
      admissions(connection, topics::kAdmission, qos_profiles::Admission()),
      frames(connection, topics::kFrame, qos_profiles::Frame()),
      histories(connection, topics::kHistory, qos_profiles::PastStates()),
      from_agents(connection.participant, qos_profiles::AllAgents(connection.session)),
      joins(connection, from_agents, topics::kJoin, qos_profiles::FromMany(qos_profiles::Join())),
      proposals(connection, from_agents, topics::kProposal, qos_profiles::FromMany(qos_profiles::Proposal())) {}

void AgentGroup::SendFrame(const FrameMessage& frame, const WorldState* base) {
  const std::uint32_t readers = frames.CountReaders();
  // A new reader has no frame that this one could be the changes of.
  if (readers > 0) frames.Send(frame, readers > frame_readers_ ? nullptr : base);
  frame_readers_ = readers;
}

const WorldState* FrameStream::BaseOf(const FrameMessage& frame) const {
  // Every agent that answered the frame of the previous tick has its state. To the others this frame is resent, whole.
  const bool follows = sent_ && frame.run == sent_->run && frame.edition == sent_->edition &&
                       frame.state.tick == sent_->state.tick + 1 && HaveSameRows(frame.state, sent_->state);
  const bool whole = !follows || frame.paused || frame.last || frame.state.tick % kKeyframePeriod == 0;
  return whole ? nullptr : &sent_->state;
}

void FrameStream::Sent(const FrameMessage& frame) {
  sent_ = frame;
  sent_whole_at_.reset();
}

const FrameMessage* FrameStream::AnswerRequest(double now) {
  if (!sent_ || (sent_whole_at_ && now < *sent_whole_at_ + kWholeFrameInterval)) return nullptr;
  sent_whole_at_ = now;
  return &*sent_;
}

}  // namespace troupe::dds
