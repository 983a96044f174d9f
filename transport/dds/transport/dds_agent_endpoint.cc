#include "transport/dds/transport/dds_agent_endpoint.h"

#include <chrono>
#include <exception>
#include <new>
#include <system_error>
#include <utility>

#include "transport/protocol/messages.h"

namespace troupe::dds {

namespace {

constexpr double kMaxLeaveWait = 1.0;           // s, for which the service may acknowledge the last samples
constexpr std::size_t kMaxWaitingSessions = 4;  // a world may be large, and any participant may claim to continue a run
constexpr auto kMakePeriod = std::chrono::milliseconds(500);  // between two attempts to make the network's endpoints

Qos SessionQos(bool with_earlier) {
  const Qos qos = qos_profiles::FromMany(qos_profiles::Description());
  return with_earlier ? qos : Qos(qos) << Durability::Volatile();
}

}  // namespace

DdsAgentEndpoint::Network::Endpoints::Endpoints(const DdsConnection& connection, bool with_sessions)
    : proposals(connection, topics::kProposal, qos_profiles::Proposal()),
      frames(connection, topics::kFrame, qos_profiles::ReceivedFrame()) {
  if (with_sessions) sessions.emplace(connection, topics::kSession, SessionQos(true));
}

DdsAgentEndpoint::Network::Network(const DdsConnection& connection, std::function<void(Frames&)> on_frames,
                                   std::function<void(Sessions&)> on_sessions)
    : connection_(connection), on_frames_(std::move(on_frames)), on_sessions_(std::move(on_sessions)) {}

void DdsAgentEndpoint::Network::Make() {
  auto made = std::make_unique<Endpoints>(connection_, on_sessions_ != nullptr);
  const std::lock_guard lock(mutex_);
  endpoints_ = std::move(made);
}

void DdsAgentEndpoint::Network::Listen() {
  Frames* frames = nullptr;
  Sessions* sessions = nullptr;
  {
    const std::lock_guard lock(mutex_);
    frames = &endpoints_->frames;
    if (endpoints_->sessions) sessions = &*endpoints_->sessions;
  }
  // Without the lock: a listener may run at once, and on_frames_ may send.
  frames->Listen([this, frames] { on_frames_(*frames); });
  if (sessions != nullptr) {
    sessions->Listen([this, sessions] { on_sessions_(*sessions); });
    on_sessions_(*sessions);
  }
  // Frames that arrived before the listener was set.
  on_frames_(*frames);
}

void DdsAgentEndpoint::Network::Open() {
  const std::lock_guard lock(mutex_);
  if (endpoints_ || maker_.joinable() || closed_) return;
  // Cyclone forbids making entities on the threads of its listeners.
  maker_ = std::thread([this] {
    for (;;) {
      try {
        Make();
        return Listen();
      } catch (const std::exception& failure) {
        connection_.Report(failure.what());
      }
      std::unique_lock wait(mutex_);
      if (closing_.wait_for(wait, kMakePeriod, [this] { return closed_; })) return;
    }
  });
}

void DdsAgentEndpoint::Network::Send(const ProposalMessage& proposal) {
  const std::lock_guard lock(mutex_);
  if (endpoints_) endpoints_->proposals.Send(proposal);
}

void DdsAgentEndpoint::Network::Close() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  closing_.notify_all();
  if (maker_.joinable()) maker_.join();
  if (!endpoints_) return;
  endpoints_->frames.Close();
  if (endpoints_->sessions) endpoints_->sessions->Close();
}

DdsAgentEndpoint::DdsAgentEndpoint(const DdsConnection& connection, const std::optional<GuidPrefix>& service,
                                   bool data_sharing)
    : connection_(connection),
      data_sharing_(data_sharing),
      joins_(connection, topics::kJoin, qos_profiles::Join(connection.lease_seconds)),
      sessions_(connection, topics::kSession, SessionQos(!data_sharing)),
      admissions_(connection, topics::kAdmission, qos_profiles::Admission()),
      histories_(connection, topics::kHistory, qos_profiles::PastStates()),
      network_(
          connection, [this](Network::Frames& frames) { Deliver([&] { DrainFrames(frames); }); },
          data_sharing ? [this](Sessions& sessions) { Deliver([&] { DrainNetworkSessions(sessions); }); }
                       : std::function<void(Sessions&)>()),
      services_(connection.proves(), service) {
  if (!data_sharing) network_.Make();
}

DdsAgentEndpoint::~DdsAgentEndpoint() {
  sessions_.Close();
  admissions_.Close();
  histories_.Close();
  network_.Close();
  {
    const std::lock_guard lock(ways_mutex_);
    for (const auto& [writer, way] : ways_) {
      if (way.segment) way.segment->Close();
    }
  }
  // After the segments were closed: their threads end.
  for (Reader& reader : readers_) reader.thread.join();
  // Without it the service may learn the end only when the lease expires: if this process ends before DDS has sent all.
  troupe_wire_Join last{};
  last.run = joined_run_;
  last.leaving = true;
  for (const AgentId agent : joined_agents_) {
    last.agent = agent;
    joins_.SendWire(last);
  }
  connection_.publisher.AwaitAcknowledgments(kMaxLeaveWait);
}

void DdsAgentEndpoint::Start(AgentHandler& handler) {
  {
    const std::lock_guard lock(mutex_);
    TROUPE_CHECK(handler_ == nullptr);
    handler_ = &handler;
  }
  const auto drain_sessions = [this] { Deliver([this] { DrainSessions(); }); };
  const auto drain_admissions = [this] { Deliver([this] { DrainAdmissions(); }); };
  sessions_.Listen(drain_sessions);
  admissions_.Listen(drain_admissions);
  histories_.Listen([this] { Deliver([this] { DrainHistories(); }); });
  if (!data_sharing_) network_.Listen();
  drain_sessions();
  drain_admissions();
  Deliver([this] { DrainHistories(); });
}

void DdsAgentEndpoint::Deliver(const std::function<void()>& drain) {
  try {
    drain();
  } catch (const std::bad_alloc&) {
    const std::lock_guard lock(mutex_);
    handler_->OnOutOfMemory();
  }
}

void DdsAgentEndpoint::SelectTransports() {
  if (!data_sharing_) return;
  JoinEndedReaders();
  for (const Sender* service : sessions_.Matched()) {
    if (!services_.MayBeService(service->participant)) continue;
    const std::lock_guard lock(ways_mutex_);
    const auto [known, is_new] = ways_.try_emplace(service->writer);
    // A way is chosen once for each service.
    if (!is_new) continue;
    Way& way = known->second;
    way = {service->participant, OpenSegment(*service)};
    try {
      if (way.segment) {
        std::thread reader([this, from = way] { ReadFrames(from); });
        readers_.push_back({way.segment, std::move(reader)});
      }
    } catch (const std::system_error& error) {
      connection_.Report(std::string("no data sharing with the world service: cannot start a thread: ") + error.what());
      way.segment.reset();
    }
    if (!way.segment) network_.Open();
  }
}

std::optional<PreparedWorld> DdsAgentEndpoint::FindWorld(const WorldDescription& world) {
  const std::lock_guard lock(worlds_mutex_);
  for (const KnownWorld& known : worlds_) {
    std::shared_ptr<const Scene> scene = known.scene.lock();
    if (scene != nullptr && known.world == &world) return PreparedWorld{std::move(scene), known.hash};
  }
  return std::nullopt;
}

void DdsAgentEndpoint::JoinEndedReaders() {
  std::erase_if(readers_, [](Reader& reader) {
    if (!reader.segment.expired()) return false;
    reader.thread.join();
    return true;
  });
}

DdsAgentEndpoint::Segment DdsAgentEndpoint::OpenSegment(const Sender& service) {
  const std::optional<SharingAddress> address = ParseSharingAddress(service.sharing);
  if (!address || !IsThisBoot(*address)) return nullptr;
  Result<std::unique_ptr<AgentSegment>> segment = AgentSegment::Open(*address);
  if (segment.ok()) return std::move(segment).value();
  connection_.Report("no data sharing with the world service: " + segment.error().message);
  return nullptr;
}

void DdsAgentEndpoint::ReadFrames(const Way& way) {
  while (way.segment->Wait()) {
    Deliver([&] {
      const std::lock_guard lock(mutex_);
      DrainSegment(way);
    });
  }
}

bool DdsAgentEndpoint::IsShared(const Sender& service) {
  const std::lock_guard lock(ways_mutex_);
  const auto way = ways_.find(service.writer);
  return way != ways_.end() && way->second.segment != nullptr;
}

void DdsAgentEndpoint::DrainSegment(const Way& way) {
  switch (ReadSegment(*way.segment, way.service)) {
    case AgentSegment::Outcome::kNothing:
    case AgentSegment::Outcome::kNews:
      return;
    case AgentSegment::Outcome::kNetwork:
      EndWay(way.service);
      network_.Open();
      return;
    case AgentSegment::Outcome::kRunOver:
      EndRuns(way.service, true);
      return;
  }
}

void DdsAgentEndpoint::EndWay(const GuidPrefix& service) {
  const std::lock_guard lock(ways_mutex_);
  for (auto& [writer, way] : ways_) {
    if (way.service != service || !way.segment) continue;
    way.segment->Close();
    way.segment.reset();
  }
}

AgentSegment::Outcome DdsAgentEndpoint::ReadSegment(AgentSegment& segment, const GuidPrefix& service) {
  if (!ReadSharedSession(segment, service)) return AgentSegment::Outcome::kNetwork;
  const FrameInPlace* frame = nullptr;
  for (;;) {
    const AgentSegment::Outcome outcome = segment.Read(frame);
    if (outcome != AgentSegment::Outcome::kNews) return outcome;
    if (services_.Judge(frame->message.run, frame->message.incarnation, service) !=
        ServiceRegistry::Verdict::kService) {
      continue;
    }
    if (frame->is_checked) {
      handler_->OnCheckedFrame(frame->message);
    } else {
      handler_->OnFrame(frame->message);
    }
  }
}

bool DdsAgentEndpoint::ReadSharedSession(AgentSegment& segment, const GuidPrefix& service) {
  SessionMessage session;
  PreparedWorld prepared;
  Status reason;
  switch (segment.ReadSession(session, prepared, reason)) {
    case AgentSegment::Outcome::kNothing:
    case AgentSegment::Outcome::kRunOver:
      return true;
    case AgentSegment::Outcome::kNetwork:
      if (!reason.ok()) {
        connection_.Report("no data sharing with the world service any more: " + reason.error().message);
      }
      return false;
    case AgentSegment::Outcome::kNews:
      break;
  }
  if (services_.Judge(session.run, session.incarnation, service) != ServiceRegistry::Verdict::kService) {
    segment.ForgetSession();
    return true;
  }
  {
    const std::lock_guard lock(worlds_mutex_);
    std::erase_if(worlds_, [](const KnownWorld& known) { return known.scene.expired(); });
    worlds_.push_back({prepared.scene, &*session.world, prepared.world_hash});
  }
  handler_->OnSession(session);
  return true;
}

void DdsAgentEndpoint::DrainSessions() {
  const std::lock_guard lock(mutex_);
  for (const Sender* sender : sessions_.Matched()) services_.Discover(sender->participant);
  sessions_.Drain(
      [this](const troupe_wire_Session& session, const Sender& sender) {
        if (session.ended) {
          EndRuns(sender.participant, true);  // of the sender's own runs, which may be none
          return false;
        }
        const auto verdict = services_.JudgeAndRefuse(sessions_, session.run, session.incarnation, sender);
        return verdict != ServiceRegistry::Verdict::kNotService && !data_sharing_;
      },
      [this](const SessionMessage& session, const Sender& sender) { TakeSession(session, sender); },
      [this](const Sender& ended) {
        EndRuns(ended.participant, false);
        const std::lock_guard ways_lock(ways_mutex_);
        ways_.erase(ended.writer);
      });
  sessions_.Clear();  // a world may be large, and is received once
  SelectTransports();
}

void DdsAgentEndpoint::DrainNetworkSessions(Sessions& sessions) {
  const std::lock_guard lock(mutex_);
  sessions.Drain(
      [&](const troupe_wire_Session& session, const Sender& sender) {
        // The end of a service, and sessions that are shared, come otherwise.
        if (session.ended || IsShared(sender)) return false;
        return services_.JudgeAndRefuse(sessions, session.run, session.incarnation, sender) !=
               ServiceRegistry::Verdict::kNotService;
      },
      [this](const SessionMessage& session, const Sender& sender) { TakeSession(session, sender); });
  sessions.Clear();  // a world may be large, and is received once
}

void DdsAgentEndpoint::TakeSession(const SessionMessage& session, const Sender& sender) {
  if (services_.Judge(session.run, session.incarnation, sender.participant) == ServiceRegistry::Verdict::kService) {
    handler_->OnSession(session);
  } else if (waiting_.size() < kMaxWaitingSessions || waiting_.contains(sender.participant)) {
    waiting_.insert_or_assign(sender.participant, session);
  }
}

void DdsAgentEndpoint::EndRuns(const GuidPrefix& service, bool in_order) {
  for (const Way& way : SharedWays()) {
    if (way.service != service) continue;
    // The last frame. A service that ended in order may be known to have ended by its lease alone, if it had not
    // discovered this reader of its last session.
    if (ReadSegment(*way.segment, service) == AgentSegment::Outcome::kRunOver) in_order = true;
  }
  EndWay(service);
  waiting_.erase(service);
  const std::vector<RunId> ended = services_.Forget(service);
  for (const RunId run : ended) {
    // The late end of an earlier run of the session is of no concern to this agent.
    const RunId joined = joined_run_;
    if (run != joined && (joined != 0 || !services_.empty())) continue;
    if (in_order) {
      handler_->OnServiceGone();
    } else {
      handler_->OnServiceLost();
    }
  }
  FollowSuccessor();
}

void DdsAgentEndpoint::FollowSuccessor() {
  std::erase_if(waiting_, [this](const auto& waiting) {
    const auto& [service, session] = waiting;
    if (services_.Judge(session.run, session.incarnation, service) != ServiceRegistry::Verdict::kService) return false;
    handler_->OnSession(session);
    return true;
  });
  for (const Way& way : SharedWays()) DrainSegment(way);
}

std::vector<DdsAgentEndpoint::Way> DdsAgentEndpoint::SharedWays() {
  const std::lock_guard lock(ways_mutex_);
  std::vector<Way> shared;
  for (const auto& [writer, way] : ways_) {
    if (way.segment) shared.push_back(way);
  }
  return shared;
}

void DdsAgentEndpoint::DrainAdmissions() {
  const std::lock_guard lock(mutex_);
  admissions_.Drain(AdmitAll(), [this](const std::vector<AdmissionMessage>& admissions, const Sender& sender) {
    for (const AdmissionMessage& admission : admissions) {
      if (services_.Admits(admissions_, admission.run, admission.incarnation, sender)) handler_->OnAdmission(admission);
    }
  });
}

void DdsAgentEndpoint::DrainFrames(Network::Frames& frames) {
  const std::lock_guard lock(mutex_);
  frames.Drain([&](const troupe_wire_Frame& frame,
                   const Sender& sender) { return services_.Admits(frames, frame.run, frame.incarnation, sender); },
               [this](const FrameMessage& frame, const Sender&) { handler_->OnFrame(frame); });
}

void DdsAgentEndpoint::DrainHistories() {
  const std::lock_guard lock(mutex_);
  histories_.Drain(
      [this](const troupe_wire_History& history, const Sender& sender) {
        return services_.Admits(histories_, history.run, history.incarnation, sender);
      },
      [this](const HistoryMessage& history, const Sender&) { handler_->OnHistory(history); });
  histories_.Clear();  // large, and seldom
}

void DdsAgentEndpoint::SendJoin(const JoinMessage& join) {
  joined_run_ = join.run;
  {
    const std::lock_guard lock(joined_mutex_);
    joined_agents_.insert(join.agent);
  }
  joins_.Send(join);
}

void DdsAgentEndpoint::SendProposal(const ProposalMessage& proposal) {
  bool needs_network = !data_sharing_;
  {
    const std::lock_guard lock(ways_mutex_);
    for (const auto& [writer, way] : ways_) {
      // An agent that has not got a slot yet (kNotJoined) does not need the network: the service does not expect its
      // proposal.
      if (way.segment && way.segment->Send(proposal) != AgentSegment::Sent::kImpossible) continue;
      needs_network = true;
    }
  }
  if (!needs_network) return;
  network_.Open();
  network_.Send(proposal);
}

}  // namespace troupe::dds
