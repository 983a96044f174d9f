#include "ros/participant/agent_endpoints.h"

#include <fmt/format.h>
#include <sys/ioctl.h>

#include <algorithm>

#include "common/base/identity.h"
#include "common/base/text.h"
#include "ros/connection/topic_types.h"
#include "ros/messages/messages.h"
#include "transport/dds/binding/wire.h"
#include "transport/wire/cdr.h"

namespace troupe::ros {
namespace {

// Bytes that wait for an agent; beyond them it gets no samples and requests.
constexpr std::size_t kMaxPending = std::size_t{4} << 20;

// For which an endpoint of an agent that has ended waits for the next one: the time of an edit, or of the restart of an
// agent.
constexpr auto kKept = std::chrono::seconds(2);
// Of a service whose clients wait; and where ticks wait, because nodes that discover others would lose messages.
constexpr auto kKeptForWaiting = std::chrono::seconds(30);

bool HasWaiting(const ReusableService& service) {
  return service.has_unanswered();
}
template <typename Endpoint>
bool HasWaiting(const Endpoint&) {
  return false;
}

template <typename Used, typename Pool>
void Retire(Used& used, Pool& pool, bool ticks_wait) {
  used.endpoint->Detach();
  const auto time = ticks_wait || HasWaiting(*used.endpoint) ? kKeptForWaiting : kKept;
  pool.Keep(std::move(used.text), std::move(used.endpoint), std::chrono::steady_clock::now() + time);
}

template <typename Endpoints, typename Pool>
void RetireAll(Endpoints& endpoints, Pool& pool, bool ticks_wait) {
  for (auto& [id, used] : endpoints) Retire(used, pool, ticks_wait);
  endpoints.clear();
}

template <typename Endpoints, typename Pool>
void RetireOne(Endpoints& endpoints, std::uint32_t id, Pool& pool) {
  const auto found = endpoints.find(id);
  if (found == endpoints.end()) return;
  Retire(found->second, pool, false);
  endpoints.erase(found);
}

// The same for the endpoints of another agent that replaces this one.
std::string TextForAll(MadeText endpoint) {
  endpoint.node = kNothing;
  return ToText(endpoint);
}

std::string TextOf(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace

void HostDomain::ServeCycloneIfFound() {
  if (!cyclone_programs || !cyclone_programs->Found()) return;
  cyclone_programs.reset();
  on_cyclone = true;
  for (AgentEndpoints* const agent : agents) agent->ServeCyclone();
  pools.services.VisitAll([](ReusableService& service) { service.ServeCyclone(); });
  announce_at = Time::clock::now();
}

void HostDomain::BeginRound(const std::string& text) {
  const std::size_t tick_at = text.rfind(' ');
  // A text without a tick is of a process that prepares to wait. What one before it has begun goes on.
  const bool prepares = tick_at == std::string::npos;
  if (prepares && frame_series.starts_with(text)) return;
  if (gate->Arm(text) && !prepares) {
    const std::string series = text.substr(0, tick_at);
    const bool is_new_run = std::exchange(frame_series, series) != series;
    for (AgentEndpoints* const agent : agents) agent->BeginRound(is_new_run);
    pools.readers.VisitAll([is_new_run](ReusableReader& reader) { reader.BeginRound(is_new_run); });
  }
  watch->Arm(text);
}

void AgentEndpoints::BeginRound(bool is_new_run) {
  for (const auto& [id, reader] : readers_) reader.endpoint->BeginRound(is_new_run);
}

AgentEndpoints::AgentEndpoints(Join join, int connection, std::function<void()> wake)
    : join_(std::move(join)), link_(connection), wake_(std::move(wake)) {}

AgentEndpoints::~AgentEndpoints() {
  if (domain_ == nullptr) return;
  const bool ticks_wait = domain_->gate.has_value();
  for (const auto& [id, service] : services_) ReturnCalls(id);
  RetireAll(writers_, domain_->pools.writers, ticks_wait);
  for (const auto& [id, reader] : readers_) domain_->readers.Remove(reader.endpoint->topic());
  RetireAll(readers_, domain_->pools.readers, ticks_wait);
  RetireAll(services_, domain_->pools.services, ticks_wait);
  for (const auto& [id, node] : nodes_) domain_->participant.RemoveNode(node);
  if (domain_->gate) domain_->gate->Remove(*this);
  if (domain_->watch) domain_->watch->RemoveAll(this);
  if (domain_->waiting == this) domain_->waiting = nullptr;
  domain_->agents.erase(this);
}

void AgentEndpoints::ServeCyclone() {
  for (auto& [id, service] : services_) service.endpoint->ServeCyclone();
}

bool AgentEndpoints::Process() {
  bool is_open = link_.ReadArrived();
  // The text of a tick is sent before its agents see the tick: so it is known here before their messages of the tick,
  // which have all been read by now.
  AgentEndpoints* const waiting = domain_ != nullptr ? domain_->waiting : nullptr;
  if (waiting != nullptr && waiting != this) waiting->ProcessUnread();
  is_processing_ = true;
  is_open = link_.Deliver([this](const LinkMessage& message) {
    if (!problem_.empty()) return;
    try {
      Perform(message);
    } catch (const dds::Exception& exception) {
      Refuse(exception.what());
    }
  }) && is_open;
  is_processing_ = false;
  return link_.Flush() && is_open && problem_.empty();
}

void AgentEndpoints::ProcessUnread() {
  int unread = 0;
  while (!is_processing_ && Process() && ioctl(link_.descriptor(), FIONREAD, &unread) == 0 && unread > 0) {
  }
}

bool AgentEndpoints::ConsumeAnnouncement() {
  return std::exchange(must_announce_, false);
}

bool AgentEndpoints::Reads(const std::string& topic) const {
  return std::any_of(readers_.begin(), readers_.end(),
                     [&topic](const auto& reader) { return reader.second.endpoint->topic() == topic; });
}

void AgentEndpoints::Report(const std::string& line) {
  Send(LinkKind::kMismatch, 0, std::as_bytes(std::span(line)));
}

void AgentEndpoints::Perform(const LinkMessage& message) {
  if ((domain_ == nullptr) != (message.kind == LinkKind::kHello)) {
    return Refuse("found no version, or two, expected one first");
  }
  switch (message.kind) {
    case LinkKind::kHello: {
      const Result<HelloText> hello = ParseHello(TextOf(message.content));
      if (!hello.ok()) return Refuse(hello.error().message);
      const std::string& version = hello.value().version;
      if (version != VersionText()) {
        return Refuse(fmt::format("found version '{}', expected '{}'", PlainLine(version, 100), VersionText()));
      }
      domain_ = &join_(hello.value().domain);
      domain_->agents.insert(this);
      shows_ticks_ = hello.value().shows_ticks;
      return;
    }
    case LinkKind::kMake: {
      const Result<MadeText> made = ParseMade(TextOf(message.content));
      if (!made.ok()) return Refuse(made.error().message);
      return Make(message.id, made.value());
    }
    case LinkKind::kRemove:
      return Remove(message.id);
    case LinkKind::kAnnounce:
      must_announce_ = true;
      return;
    case LinkKind::kWrite:
    case LinkKind::kWriteAgain:
      return Write(message);
    case LinkKind::kShown:
      if (domain_->gate) domain_->gate->OnShown(*this);
      return;
    case LinkKind::kSettle:
      return Send(LinkKind::kSettled, kNothing);
    case LinkKind::kArm:
      PrepareToWait();
      domain_->BeginRound(TextOf(message.content));
      return Send(LinkKind::kArrived, kNothing, message.content);
    case LinkKind::kShow:
      if (domain_->gate) domain_->gate->Show();
      return;
    case LinkKind::kAwait:
      awaited_ = ToIds(message.content);
      if (domain_->gate) domain_->gate->Await(*this, awaited_);
      return;
    case LinkKind::kCollect:
      return Collect();
    case LinkKind::kTell:
      return Tell(message);
    default:
      return Refuse("found a message for agents");
  }
}

void AgentEndpoints::PrepareToWait() {
  domain_->waiting = this;
  if (domain_->gate) return;
  domain_->watch.emplace(domain_->participant, domain_->readers, wake_);
  domain_->shared_gate = &domain_->gate.emplace(domain_->participant, *domain_->watch);
}

void AgentEndpoints::Watch(std::uint32_t id, const std::string& watched) {
  PrepareToWait();
  domain_->watch->Add(
      this, id, watched,
      {.on_arrival = [this,
                      id](const std::string& text) { Send(LinkKind::kArrived, id, std::as_bytes(std::span(text))); },
       .on_timed =
           [this, id](bool is_timed) {
             Send(LinkKind::kTimed, id, std::as_bytes(std::span(is_timed ? std::string_view() : kNotTimed)));
           }});
}

// What an agent has sent before it said so by another way can be read here.
void AgentEndpoints::Collect() {
  // A copy: processing messages may add agents to the domain or move them.
  const std::set<AgentEndpoints*> agents = domain_->agents;
  for (AgentEndpoints* const agent : agents) {
    if (agent == this) continue;
    agent->ProcessUnread();
    must_announce_ = agent->ConsumeAnnouncement() || must_announce_;
  }
}

void AgentEndpoints::Tell(const LinkMessage& message) {
  const auto found = writers_.find(message.id);
  const dds_topic_descriptor_t& type = *dds::TopicTraits<Header>::descriptor();
  if (found == writers_.end() || &found->second.endpoint->type() != &type) return Refuse("found a header of no writer");
  const wire::UntypedSample sample(type);
  const Status decoded = wire::SampleFromCdr(message.content, type, sample.data());
  if (!decoded.ok()) return Refuse(decoded.error().message);
  PrepareToWait();
  const Header& header = *static_cast<const Header*>(sample.data());
  domain_->gate->Tell(*this, {message.id, {header.stamp.sec, header.stamp.nanosec, dds::Text(header.frame_id)}},
                      awaited_);
}

void AgentEndpoints::Announce(const TickGate::Announcement& announcement, const std::string& topics, int tells) {
  const auto found = writers_.find(announcement.writer);
  if (found == writers_.end()) return;
  dds::WireArena arena;
  Header header{};
  header.stamp = {announcement.tick.seconds, announcement.tick.nanoseconds};
  header.frame_id = arena.Copy(topics);
  // First, because an answer may arrive at once.
  const auto told = wire::SampleToCdr(&header, found->second.endpoint->type());
  for (; tells > 0; --tells) Send(LinkKind::kTold, announcement.writer, told);
  if (!found->second.endpoint->writer().Write(&header)) domain_->participant.CountLost();
}

void AgentEndpoints::SendHeld(const std::set<std::uint32_t>& absent) {
  Send(LinkKind::kHeld, kNothing, ToBytes(absent));
}

void AgentEndpoints::SendCalling(const std::set<std::uint32_t>& calling) {
  Send(LinkKind::kCalling, kNothing, ToBytes(calling));
}

std::set<AgentEndpoints*> AgentEndpoints::AskToShow() {
  std::set<AgentEndpoints*> asked;
  for (AgentEndpoints* const agent : domain_->agents) {
    if (!agent->shows_ticks_) continue;
    agent->Send(LinkKind::kShowAgain, kNothing);
    asked.insert(agent);
  }
  return asked;
}

void AgentEndpoints::Make(std::uint32_t id, const MadeText& made) {
  if (nodes_.contains(id) || writers_.contains(id) || readers_.contains(id) || services_.contains(id)) {
    return Refuse("found an id a second time");
  }
  if (made.kind == MadeKind::kWatch) return Watch(id, made.name);
  if (made.kind == MadeKind::kDistributionWatch) {
    watches_distributions_ = true;
    return domain_->participant.WatchDistributions();
  }
  if (made.kind == MadeKind::kNode) return MakeNode(id, made.name);
  std::size_t node = kNoNode;
  if (made.node != kNothing) {
    const auto found = nodes_.find(made.node);
    if (found == nodes_.end()) return Refuse(fmt::format("found node {}, expected one of this agent", made.node));
    node = found->second;
  }
  if (made.kind == MadeKind::kWriter) return MakeWriter(id, node, made);
  if (made.kind == MadeKind::kReader) return MakeReader(id, node, made);
  MakeService(id, node, made);
}

void AgentEndpoints::MakeNode(std::uint32_t id, const std::string& name) {
  const std::size_t slash = name.rfind('/');
  if (slash == std::string::npos) return Refuse("found node '" + PlainLine(name, 100) + "', expected '/robot' or so");
  const std::string node_namespace = slash == 0 ? "/" : name.substr(0, slash);
  const std::size_t node = domain_->participant.AddNode(node_namespace, name.substr(slash + 1));
  nodes_[id] = node;
  for (const std::uint32_t log : logs_) domain_->participant.ShareWriter(node, writers_.at(log).endpoint->writer());
}

void AgentEndpoints::ReturnCalls(std::uint32_t service) {
  const auto found = services_.find(service);
  if (found == services_.end() || !domain_->gate) return;
  found->second.endpoint->StopPassing();
  for (HeldCalls::Call& call : domain_->gate->TakeCalls(*this, service)) {
    found->second.endpoint->Return(std::move(call.request), call.caller);
  }
}

void AgentEndpoints::Remove(std::uint32_t id) {
  ReturnCalls(id);
  logs_.erase(id);
  if (domain_->watch) domain_->watch->Remove(this, id);
  if (const auto found = readers_.find(id); found != readers_.end()) {
    domain_->readers.Remove(found->second.endpoint->topic());
  }
  RetireOne(writers_, id, domain_->pools.writers);
  RetireOne(readers_, id, domain_->pools.readers);
  RetireOne(services_, id, domain_->pools.services);
}

void AgentEndpoints::MakeWriter(std::uint32_t id, std::size_t node, const MadeText& made) {
  const dds_topic_descriptor_t* const type = TypeOf(made.type);
  if (type == nullptr) return;
  std::string text = TextForAll(made);
  std::unique_ptr<ReusableWriter> writer = domain_->pools.writers.Acquire(text);
  if (!writer) writer = std::make_unique<ReusableWriter>(domain_->participant, TopicSpec{made.name, type, made.qos});
  writer->Attach(node, [this, id](bool wanted, bool is_new) {
    const MatchedContent content = {wanted, is_new};
    Send(LinkKind::kMatched, id, std::as_bytes(std::span(&content, 1)));
    // Behind kMatched, so that an agent that is asked to show its tick knows of the reader.
    TickGate* const gate = domain_->shared_gate;
    if (!is_new || gate == nullptr) return;
    gate->NoteReader();
    wake_();
  });
  if (made.qos.kind == TopicQos::Kind::kLogLines) {
    logs_.insert(id);
    for (const auto& [other, of_participant] : nodes_) {
      if (of_participant != node) domain_->participant.ShareWriter(of_participant, writer->writer());
    }
  }
  writers_[id] = {std::move(text), std::move(writer)};
}

void AgentEndpoints::MakeReader(std::uint32_t id, std::size_t node, const MadeText& made) {
  const dds_topic_descriptor_t* const type = TypeOf(made.type);
  if (type == nullptr) return;
  std::string text = TextForAll(made);
  domain_->readers.Add(made.name);
  std::unique_ptr<ReusableReader> reader = domain_->pools.readers.Acquire(text);
  if (!reader) {
    reader = std::make_unique<ReusableReader>(domain_->participant, TopicSpec{made.name, type, made.qos}, made.part);
    if (domain_->gate) reader->BeginRound(false);
  }
  reader->Attach(node, {[this, id, topic = made.name](std::span<const std::byte> sample, bool is_again) {
                          Send(LinkKind::kSample, id, sample);
                          if (!is_again) domain_->readers.Note(topic);
                        },
                        [this, id] { Send(LinkKind::kMatched, id); }});
  readers_[id] = {std::move(text), std::move(reader)};
}

void AgentEndpoints::MakeService(std::uint32_t id, std::size_t node, const MadeText& made) {
  const dds_topic_descriptor_t* const request = TypeOf(made.type);
  const dds_topic_descriptor_t* const response = TypeOf(made.response_type);
  if (request == nullptr || response == nullptr) return;
  std::string text = TextForAll(made);
  std::unique_ptr<ReusableService> service = domain_->pools.services.Acquire(text);
  if (!service) {
    service =
        std::make_unique<ReusableService>(domain_->participant, ServiceSpec{made.name, request, response, made.qos},
                                          domain_->number, domain_->fast_dds, domain_->on_cyclone);
  }
  service->Attach(node, [this, id](std::span<const std::byte> bytes, bool is_repeated, dds_instance_handle_t caller) {
    if (is_repeated) return Send(LinkKind::kRepeated, id, bytes);
    TickGate* const gate = domain_->shared_gate;
    if (gate == nullptr || caller == DDS_HANDLE_NIL) return SendRequest(id, bytes);
    gate->Call({.agent = this, .service = id, .caller = caller, .request = {bytes.begin(), bytes.end()}});
    wake_();
  });
  services_[id] = {std::move(text), std::move(service)};
}

void AgentEndpoints::Write(const LinkMessage& message) {
  const bool is_again = message.kind == LinkKind::kWriteAgain;
  if (const auto writer = writers_.find(message.id); writer != writers_.end()) {
    if (!domain_->gate) return WriteSample(message.id, message.content);
    return domain_->gate->Write(*this, message.id, *writer->second.endpoint, message.content, is_again);
  }
  const auto service = services_.find(message.id);
  if (service == services_.end() || is_again) return Refuse("found a sample of no writer or service");
  const wire::UntypedSample sample(service->second.endpoint->response());
  const Status decoded = wire::SampleFromCdr(message.content, service->second.endpoint->response(), sample.data());
  if (!decoded.ok()) return Refuse(decoded.error().message);
  if (!service->second.endpoint->Respond(sample.data(), message.content)) domain_->participant.CountLost();
}

void AgentEndpoints::WriteSample(std::uint32_t id, std::span<const std::byte> bytes) {
  const auto found = writers_.find(id);
  if (found == writers_.end()) return;
  ReusableWriter& writer = *found->second.endpoint;
  const wire::UntypedSample sample(writer.type());
  const Status decoded = wire::SampleFromCdr(bytes, writer.type(), sample.data());
  if (!decoded.ok()) return Refuse(decoded.error().message);
  if (!writer.writer().Write(sample.data())) domain_->participant.CountLost();
}

const dds_topic_descriptor_t* AgentEndpoints::TypeOf(const std::string& name) {
  const dds_topic_descriptor_t* const type = FindTopicType(name, domain_->participant.distribution());
  if (type == nullptr) Refuse(fmt::format("found type '{}', expected one of ROS that robots use", name));
  return type;
}

void AgentEndpoints::Send(LinkKind kind, std::uint32_t id, std::span<const std::byte> content) {
  const bool may_be_dropped = kind == LinkKind::kSample || kind == LinkKind::kRepeated;
  // An agent that hangs must not fill this process's memory; what it misses, DDS would have dropped as well.
  if (may_be_dropped && link_.pending() > kMaxPending) return;
  link_.Add(kind, id, content);
  // At once, so that an acknowledged command is with the agent.
  if (!link_.Flush() || link_.pending() > 0) wake_();
}

void AgentEndpoints::Refuse(const std::string& problem) {
  if (problem_.empty()) problem_ = problem;
}

}  // namespace troupe::ros
