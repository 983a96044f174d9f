#include "transport/dds/transport/dds_agent_endpoint.h"

#include <chrono>
#include <exception>
#include <new>
#include <system_error>
#include <utility>

#include "transport/protocol/messages.h"

namespace troupe::dds {

namespace {

constexpr double kMaxLeaveWait = 1.0;  // s, for which the service may acknowledge the last samples
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
    const std::lock_guard lock(segments_mutex_);
    for (const auto& [writer, segment] : segments_) {
      if (segment) segment->Close();
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
    const std::lock_guard lock(segments_mutex_);
    const auto [way, is_new] = segments_.try_emplace(service->writer);
    // A way is chosen once for each service.
    if (!is_new) continue;
    way->second = OpenSegment(*service);
    try {
      if (way->second) {
        std::thread reader([this, segment = way->second, from = service->participant] { ReadFrames(segment, from); });
        readers_.push_back({way->second, std::move(reader)});
      }
    } catch (const std::system_error& error) {
      connection_.Report(std::string("no data sharing with the world service: cannot start a thread: ") + error.what());
      way->second.reset();
    }
    if (!way->second) network_.Open();
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

void DdsAgentEndpoint::ReadFrames(const Segment& segment, const GuidPrefix& service) {
  bool is_shared = true;
  while (is_shared && segment->Wait()) {
    Deliver([&] {
      const std::lock_guard lock(mutex_);
      is_shared = DrainSegment(*segment, service);
    });
  }
  // The service has ended sharing: its session and its later frames come over the network.
  if (is_shared) return;
  {
    const std::lock_guard lock(segments_mutex_);
    for (auto& [writer, shared] : segments_) {
      if (shared == segment) shared.reset();
    }
  }
  network_.Open();
}

bool DdsAgentEndpoint::IsShared(const Sender& service) {
  const std::lock_guard lock(segments_mutex_);
  const auto way = segments_.find(service.writer);
  return way != segments_.end() && way->second != nullptr;
}

bool DdsAgentEndpoint::DrainSegment(AgentSegment& segment, const GuidPrefix& service) {
  if (!DrainSharedSession(segment, service)) return false;
  const FrameInPlace* frame = nullptr;
  for (;;) {
    switch (segment.Read(frame)) {
      case AgentSegment::Outcome::kNothing:
        return true;
      case AgentSegment::Outcome::kNews:
        if (services_.Judge(frame->message.run, frame->message.incarnation, service) !=
            ServiceRegistry::Verdict::kService) {
          break;
        }
        if (frame->is_checked) {
          handler_->OnCheckedFrame(frame->message);
        } else {
          handler_->OnFrame(frame->message);
        }
        break;
      case AgentSegment::Outcome::kEnded:
        return false;
    }
  }
}

bool DdsAgentEndpoint::DrainSharedSession(AgentSegment& segment, const GuidPrefix& service) {
  SessionMessage session;
  PreparedWorld prepared;
  Status reason;
  switch (segment.ReadSession(session, prepared, reason)) {
    case AgentSegment::Outcome::kNothing:
      return true;
    case AgentSegment::Outcome::kEnded:
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
  sessions_.Drain(
      [this](const troupe_wire_Session& session, const Sender& sender) {
        if (!services_.Admits(sessions_, session.run, session.incarnation, sender)) return false;
        if (session.ended) EndRuns(sender, true);
        return !session.ended && !data_sharing_;
      },
      [this](const SessionMessage& session, const Sender&) { handler_->OnSession(session); },
      [this](const Sender& ended) {
        EndRuns(ended, false);
        const std::lock_guard segments_lock(segments_mutex_);
        segments_.erase(ended.writer);
      });
  sessions_.Clear();  // a world may be large, and is received once
  SelectTransports();
}

void DdsAgentEndpoint::DrainNetworkSessions(Sessions& sessions) {
  const std::lock_guard lock(mutex_);
  sessions.Drain(
      [&](const troupe_wire_Session& session, const Sender& sender) {
        // The end of a service, and sessions that are shared, come otherwise.
        return !session.ended && !IsShared(sender) &&
               services_.Admits(sessions, session.run, session.incarnation, sender);
      },
      [this](const SessionMessage& session, const Sender&) { handler_->OnSession(session); });
  sessions.Clear();  // a world may be large, and is received once
}

void DdsAgentEndpoint::EndRuns(const Sender& service, bool in_order) {
  Segment segment;
  {
    const std::lock_guard lock(segments_mutex_);
    if (const auto way = segments_.find(service.writer); way != segments_.end()) segment = std::move(way->second);
  }
  if (segment) {
    DrainSegment(*segment, service.participant);  // the last frame
    segment->Close();
  }
  for (const RunId run : services_.Forget(service.participant)) {
    // The late end of an earlier run of the session is of no concern to this agent.
    const RunId joined = joined_run_;
    if (run != joined && (joined != 0 || !services_.empty())) continue;
    if (in_order) {
      handler_->OnServiceGone();
    } else {
      handler_->OnServiceLost();
    }
  }
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
    const std::lock_guard lock(segments_mutex_);
    for (const auto& [writer, segment] : segments_) {
      // An agent that has not got a slot yet (kNotJoined) does not need the network: the service does not expect its
      // proposal.
      if (segment && segment->Send(proposal) != AgentSegment::Sent::kImpossible) continue;
      needs_network = true;
    }
  }
  if (!needs_network) return;
  network_.Open();
  network_.Send(proposal);
}

}  // namespace troupe::dds
