#include "common/dds/transport/dds_service_endpoint.h"

#include <algorithm>
#include <chrono>
#include <new>
#include <utility>

#include "common/protocol/agent_name.h"
#include "common/protocol/topics.h"

namespace troupe::dds {
namespace {

using Clock = std::chrono::steady_clock;

// Agents that may join through one writer: an agent that rejoins as another one is a new agent.
constexpr std::ptrdiff_t kAgentsOfWriter = 64;

// Lost agents whose proposals are still accepted: the run asks them to join again.
constexpr std::size_t kLostAgentsKept = 1024;

std::unique_ptr<ServiceSegment> MakeSegment(const DdsConnection& connection, bool data_sharing) {
  if (!data_sharing) return nullptr;
  Result<std::unique_ptr<ServiceSegment>> segment = ServiceSegment::Create();
  if (segment.ok()) return std::move(segment).value();
  connection.Report("no data sharing: " + segment.error().message);
  return nullptr;
}

}  // namespace

DdsServiceEndpoint::DdsServiceEndpoint(const DdsConnection& connection, bool data_sharing)
    : connection_(connection),
      segment_(MakeSegment(connection, data_sharing)),
      sessions_(connection, topics::kSession, qos_profiles::Description(connection.lease_seconds),
                segment_ ? ToText(segment_->address()) : std::string()),
      admissions_(connection, topics::kAdmission, qos_profiles::Admission()),
      frames_(connection, topics::kFrame, qos_profiles::Frame()),
      whole_frames_(connection, topics::kWholeFrame, qos_profiles::WholeFrame()),
      histories_(connection, topics::kHistory, qos_profiles::PastStates()),
      statuses_(connection, topics::kStatus, qos_profiles::Status()),
      control_replies_(connection, topics::kControlReply, qos_profiles::ControlReply()),
      from_agents_(connection.participant, qos_profiles::AllAgents(connection.session)),
      joins_(connection, from_agents_, topics::kJoin, qos_profiles::FromMany(qos_profiles::Join())),
      proposals_(connection, from_agents_, topics::kProposal, qos_profiles::FromMany(qos_profiles::Proposal())),
      controls_(connection, topics::kControl, qos_profiles::FromMany(qos_profiles::Control())),
      frame_requests_(connection, topics::kFrameRequest, qos_profiles::FromMany(qos_profiles::FrameRequest())),
      rivals_(connection, topics::kSession,
              qos_profiles::FromMany(qos_profiles::Description()) << IgnoreLocal::Participant()),
      secured_(connection.secured),
      proven_(connection.proves()) {}

DdsServiceEndpoint::~DdsServiceEndpoint() {
  joins_.Close();
  proposals_.Close();
  controls_.Close();
  frame_requests_.Close();
  rivals_.Close();
  if (collector_.joinable()) {
    segment_->Close();
    collector_.join();
  }
  if (run_ == 0) return;
  troupe_wire_Session last{};
  last.run = run_;
  last.ended = true;
  sessions_.SendWire(last);
}

void DdsServiceEndpoint::Start(ServiceHandler& handler) {
  {
    const std::lock_guard lock(mutex_);
    TROUPE_CHECK(handler_ == nullptr);
    handler_ = &handler;
  }
  joins_.Listen([this] { Deliver(&DdsServiceEndpoint::DrainJoins); });
  proposals_.Listen([this] { Deliver(&DdsServiceEndpoint::DrainProposals); });
  controls_.Listen([this] { Deliver(&DdsServiceEndpoint::DrainControls); });
  frame_requests_.Listen([this] { Deliver(&DdsServiceEndpoint::DrainFrameRequests); });
  rivals_.Listen([this] { Deliver(&DdsServiceEndpoint::DrainSessions); });
  DrainSessions();
  DrainJoins();
  DrainProposals();
  DrainControls();
  DrainFrameRequests();
  if (segment_) collector_ = std::thread([this] { CollectAnswers(); });
}

void DdsServiceEndpoint::CollectAnswers() {
  while (segment_->Wait()) {
    Deliver(&DdsServiceEndpoint::DrainAnswers);
  }
}

void DdsServiceEndpoint::DrainAnswers() {
  const std::lock_guard lock(mutex_);
  for (const SharedAnswer& answer : segment_->Collect()) {
    if (answer.malformed.ok()) {
      handler_->OnProposal(answer.proposal);
    } else {
      proposals_.ReportMalformed(answer.malformed.error());
    }
  }
}

void DdsServiceEndpoint::Deliver(void (DdsServiceEndpoint::*drain)()) {
  try {
    (this->*drain)();
  } catch (const std::bad_alloc&) {
    const std::lock_guard lock(mutex_);
    handler_->OnOutOfMemory();
  }
}

void DdsServiceEndpoint::DrainJoins() {
  const std::lock_guard lock(mutex_);
  joins_.Drain(
      [this](const troupe_wire_Join& join, const Sender& sender) {
        if (join.leaving) {
          Leave(join.agent, sender);
          return false;
        }
        if (!MayJoinFor(Strings(join.robots), sender)) {
          joins_.Refuse(sender, "its keys are those of an agent of other robots");
          return false;
        }
        if (Bind(join.agent, sender)) return true;
        joins_.Refuse(sender, "it joins as the agent of another participant, or as too many");
        return false;
      },
      [this](const JoinMessage& join, const Sender&) { handler_->OnJoin(join); },
      [this](const Sender& ended) { LoseAgentsOf(ended); });
}

bool DdsServiceEndpoint::Bind(AgentId agent, const Sender& sender) {
  if (const auto known = agents_.find(agent); known != agents_.end()) return known->second.writer == sender.writer;
  const auto is_of_sender = [&](const auto& other) { return other.second.writer == sender.writer; };
  if (std::count_if(agents_.begin(), agents_.end(), is_of_sender) >= kAgentsOfWriter) return false;
  agents_.emplace(agent, sender);
  lost_agents_.erase(agent);
  if (segment_) segment_->Bind(agent);
  return true;
}

bool DdsServiceEndpoint::MayJoinFor(const std::vector<std::string>& robots, const Sender& sender) {
  if (!secured_) return true;
  // The permissions of its keys have the name, and so has the partition, which DDS Security has compared with them.
  const std::string name = qos_profiles::AgentOfPartition(sender.partition);
  if (AgentName(robots) == name) robots_of_agents_[name] = {robots.begin(), robots.end()};
  // After an edit it may join for those that are left.
  const auto known = robots_of_agents_.find(name);
  return known != robots_of_agents_.end() && std::all_of(robots.begin(), robots.end(), [&](const std::string& robot) {
           return known->second.contains(robot);
         });
}

void DdsServiceEndpoint::Leave(AgentId agent, const Sender& sender) {
  const auto known = agents_.find(agent);
  if (known == agents_.end() || known->second.writer != sender.writer) return;
  agents_.erase(known);
  if (segment_) segment_->Unbind(agent);
  handler_->OnAgentGone(agent);
}

void DdsServiceEndpoint::LoseAgentsOf(const Sender& ended) {
  std::vector<AgentId> lost;
  for (const auto& [agent, sender] : agents_) {
    if (sender.writer == ended.writer) lost.push_back(agent);
  }
  for (const AgentId agent : lost) {
    agents_.erase(agent);
    if (lost_agents_.size() == kLostAgentsKept) {
      if (segment_) segment_->Unbind(lost_agents_.begin()->first);
      lost_agents_.erase(lost_agents_.begin());
    }
    lost_agents_[agent] = ended.participant;
    handler_->OnAgentGone(agent);
  }
}

bool DdsServiceEndpoint::IsFromAgent(AgentId agent, const Sender& sender) {
  if (const auto known = agents_.find(agent); known != agents_.end()) {
    if (known->second.participant == sender.participant) return true;
    proposals_.Refuse(sender, "another participant is this agent");
    return false;
  }
  const auto lost = lost_agents_.find(agent);
  return lost != lost_agents_.end() && lost->second == sender.participant;
}

void DdsServiceEndpoint::DrainProposals() {
  const std::lock_guard lock(mutex_);
  proposals_.Drain([this](const troupe_wire_Proposal& proposal,
                          const Sender& sender) { return IsFromAgent(proposal.agent, sender); },
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
  sessions_.Send(session);
}
void DdsServiceEndpoint::SendAdmissions(const std::vector<AdmissionMessage>& admissions) {
  admissions_.Send(admissions);
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
  const std::uint32_t readers = frames_.CountReaders();
  // A new reader has no frame that this one could be the changes of.
  const WorldState* const base = readers > frame_readers_ ? nullptr : stream_.BaseOf(frame);
  if (readers > 0) frames_.Send(frame, base);
  frame_readers_ = readers;
  stream_.Sent(frame);
}

void DdsServiceEndpoint::SendHistory(const HistoryMessage& history) {
  histories_.Send(history);
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
