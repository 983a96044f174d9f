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
constexpr auto kKeptWithCalls = std::chrono::seconds(30);  // a service whose clients wait

std::chrono::seconds KeptTime(const ReusableService& service) {
  return service.has_unanswered() ? kKeptWithCalls : kKept;
}
template <typename Endpoint>
std::chrono::seconds KeptTime(const Endpoint&) {
  return kKept;
}

template <typename Used, typename Pool>
void Retire(Used& used, Pool& pool) {
  used.endpoint->Detach();
  const auto until = std::chrono::steady_clock::now() + KeptTime(*used.endpoint);
  pool.Keep(std::move(used.text), std::move(used.endpoint), until);
}

template <typename Endpoints, typename Pool>
void RetireAll(Endpoints& endpoints, Pool& pool) {
  for (auto& [id, used] : endpoints) Retire(used, pool);
  endpoints.clear();
}

template <typename Endpoints, typename Pool>
void RetireOne(Endpoints& endpoints, std::uint32_t id, Pool& pool) {
  const auto found = endpoints.find(id);
  if (found == endpoints.end()) return;
  Retire(found->second, pool);
  endpoints.erase(found);
}

// The same for the endpoints of another agent that replaces this one.
std::string TextForAll(MadeText endpoint) {
  endpoint.node = kNothing;
  return ToText(endpoint);
}

// "/scan" for "rt/scan"; empty for what nodes wait for in no case.
std::string TopicToTell(const std::string& on_dds) {
  if (!on_dds.starts_with("rt/")) return {};
  std::string topic = on_dds.substr(2);
  if (topic == "/clock" || topic == "/rosout" || topic == "/parameter_events") topic.clear();
  return topic;
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

AgentEndpoints::AgentEndpoints(Join join, int connection, std::function<void()> wake)
    : join_(std::move(join)), link_(connection), wake_(std::move(wake)) {}

AgentEndpoints::~AgentEndpoints() {
  if (domain_ == nullptr) return;
  RetireAll(writers_, domain_->pools.writers);
  for (const auto& [id, reader] : readers_) domain_->readers.Remove(reader.endpoint->topic());
  RetireAll(readers_, domain_->pools.readers);
  RetireAll(services_, domain_->pools.services);
  for (const auto& [id, node] : nodes_) domain_->participant.RemoveNode(node);
  if (domain_->watch) domain_->watch->RemoveAll(this);
  domain_->agents.erase(this);
}

void AgentEndpoints::ServeCyclone() {
  for (auto& [id, service] : services_) service.endpoint->ServeCyclone();
}

bool AgentEndpoints::Process() {
  const bool open = link_.Receive([this](const LinkMessage& message) {
    if (!problem_.empty()) return;
    try {
      Perform(message);
    } catch (const dds::Exception& exception) {
      Refuse(exception.what());
    }
  });
  return link_.Flush() && open && problem_.empty();
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
      return Write(message);
    case LinkKind::kArm:
      if (domain_->armed != TextOf(message.content)) domain_->written.clear();
      domain_->armed = TextOf(message.content);
      if (domain_->watch) domain_->watch->Arm(*domain_->armed);
      return Send(LinkKind::kArrived, kNothing, message.content);
    case LinkKind::kCollect:
      return Collect();
    case LinkKind::kTell:
      return Tell(message);
    default:
      return Refuse("found a message for agents");
  }
}

void AgentEndpoints::Watch(std::uint32_t id, const std::string& topic) {
  if (!domain_->watch) domain_->watch.emplace(domain_->participant, domain_->readers, wake_);
  domain_->watch->Add(
      this, id, topic,
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
    int unread = 0;
    while (ioctl(agent->link_.descriptor(), FIONREAD, &unread) == 0 && unread > 0 && agent->Process()) {
    }
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
  std::string topics;
  for (const auto& [on_dds, count] : std::exchange(domain_->written, {})) {
    const std::string topic = TopicToTell(on_dds);
    if (!topic.empty()) topics += fmt::format("{}{}:{}", topics.empty() ? "" : " ", topic, count);
  }
  dds::WireArena arena;
  Header header = *static_cast<const Header*>(sample.data());
  header.frame_id = arena.Copy(topics);
  // First, because an answer may arrive at once.
  Send(LinkKind::kTold, message.id, wire::SampleToCdr(&header, type));
  if (!found->second.endpoint->writer().Write(&header)) domain_->participant.CountLost();
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

void AgentEndpoints::Remove(std::uint32_t id) {
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
  }
  reader->Attach(node, {[this, id, type, topic = made.name](const void* sample) {
                          Send(LinkKind::kSample, id, wire::SampleToCdr(sample, *type));
                          domain_->readers.Note(topic);
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
  service->Attach(node, [this, id](std::span<const std::byte> bytes, bool is_repeated) {
    Send(is_repeated ? LinkKind::kRepeated : LinkKind::kSample, id, bytes);
  });
  services_[id] = {std::move(text), std::move(service)};
}

void AgentEndpoints::Write(const LinkMessage& message) {
  const auto writer = writers_.find(message.id);
  const auto service = services_.find(message.id);
  const bool is_sample = writer != writers_.end();
  if (!is_sample && service == services_.end()) return Refuse("found a sample of no writer or service");
  const dds_topic_descriptor_t& type =
      is_sample ? writer->second.endpoint->type() : service->second.endpoint->response();
  const wire::UntypedSample sample(type);
  const Status decoded = wire::SampleFromCdr(message.content, type, sample.data());
  if (!decoded.ok()) return Refuse(decoded.error().message);
  const bool is_written = is_sample ? writer->second.endpoint->writer().Write(sample.data())
                                    : service->second.endpoint->Respond(sample.data(), message.content);
  if (!is_written) domain_->participant.CountLost();
  // Counted even if DDS refused the sample: a node that waits for it then reports what is missing.
  if (is_sample && domain_->armed) ++domain_->written[writer->second.endpoint->topic()];
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
