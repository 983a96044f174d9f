#include "ros/link/host_connection.h"

#include <poll.h>

#include <algorithm>
#include <chrono>
#include <new>
#include <string_view>

#include "common/base/identity.h"
#include "transport/wire/cdr.h"

namespace troupe::ros {
namespace {

using Clock = std::chrono::steady_clock;

// ms between two attempts to connect.
constexpr int kFirstDelay = 5;
constexpr int kMaxDelay = 500;
constexpr auto kHealthyTime = std::chrono::seconds(1);  // of a connection; after this the delays begin again

// Unsent bytes, beyond which streams keep their newest sample only: so many that they are not old when they are sent.
constexpr std::size_t kMaxPending = std::size_t{256} << 10;
constexpr auto kMaxSend = std::chrono::seconds(1);
constexpr int kSendMilliseconds = 5;
constexpr auto kMaxSettle = std::chrono::seconds(10);
constexpr auto kMaxSettleWithoutProgram = std::chrono::seconds(1);
constexpr std::size_t kMaxRequests = 1000;  // waiting; as many as DDS would keep

std::span<const std::byte> BytesOf(std::string_view text) {
  return std::as_bytes(std::span(text));
}

MadeText MadeOf(MadeKind kind, std::size_t node, const TopicSpec& spec, Part part = Part::kOnlyReader) {
  return {.kind = kind,
          .node = static_cast<std::uint32_t>(node),
          .name = spec.topic,
          .type = spec.type->m_typename,
          .qos = spec.qos,
          .part = part};
}

}  // namespace

class HostConnection::Writer final : public TopicWriter {
 public:
  Writer(HostConnection& owner, std::size_t node, const TopicSpec& spec)
      : owner_(owner),
        type_(*spec.type),
        is_latched_(spec.qos.kind == TopicQos::Kind::kLatched),
        id_(owner.AddEndpoint(MadeOf(MadeKind::kWriter, node, spec), owner.writers_, this)) {}
  ~Writer() override { owner_.Remove(id_); }

  bool Write(const void* sample) noexcept override {
    try {
      Bytes bytes = wire::SampleToCdr(sample, type_);
      if (bytes.size() > Link::kMaxContent) return false;
      const std::lock_guard lock(owner_.mutex_);
      const bool is_full = owner_.link_ && owner_.link_->pending() > kMaxPending;
      // A latched sample is never dropped: no later one may follow.
      if (is_full && !is_latched_) {
        const bool is_first = owner_.held_.insert_or_assign(id_, std::move(bytes)).second;
        return is_first;  // else the sample that was held is lost
      }
      // An older held sample must not be sent behind this one.
      owner_.held_.erase(id_);
      owner_.Send(owner_.writes_again() && !is_latched_ ? LinkKind::kWriteAgain : LinkKind::kWrite, id_, bytes);
      if (is_latched_) owner_.latched_[id_] = std::move(bytes);
      if (owner_.sending_ == Sending::kAtOnce) owner_.FlushNow();
      return true;
    } catch (const std::bad_alloc&) {
      return false;
    }
  }

  std::uint32_t id() const { return id_; }
  const dds_topic_descriptor_t& type() const { return type_; }
  void React(const MatchedContent& content) {
    SetWanted(content.wanted);
    if (content.wanted) owner_.NoteWanted();
    if (content.is_new) NoteReader();
  }

 private:
  HostConnection& owner_;
  const dds_topic_descriptor_t& type_;
  const bool is_latched_;
  const std::uint32_t id_;
};

class HostConnection::Reader final : public TopicReader {
 public:
  Reader(HostConnection& owner, std::size_t node, const TopicSpec& spec, Part part, std::function<void()> on_arrival)
      : owner_(owner),
        on_arrival_(std::move(on_arrival)),
        type_(*spec.type),
        depth_(static_cast<std::size_t>(spec.qos.depth)),
        id_(owner.AddEndpoint(MadeOf(MadeKind::kReader, node, spec, part), owner.readers_, this)) {}
  ~Reader() override { owner_.Remove(id_); }

  // REQUIRES: the owner's mutex is held, as below.
  void Add(std::span<const std::byte> bytes) {
    waiting_.emplace_back(bytes.begin(), bytes.end());
    if (waiting_.size() > depth_) waiting_.pop_front();
    SetArrived();
    if (on_arrival_) on_arrival_();
  }
  void Miss() { SetMissedWriter(); }
  void Forget() { waiting_.clear(); }
  std::uint32_t id() const { return id_; }

 private:
  void ConsumeArrived(const Consume& consume) override {
    std::deque<Bytes> taken;
    {
      const std::lock_guard lock(owner_.mutex_);
      taken.swap(waiting_);
    }
    for (const Bytes& bytes : taken) {
      const wire::UntypedSample sample(type_);
      if (wire::SampleFromCdr(bytes, type_, sample.data()).ok()) consume(sample.data());
    }
  }

  HostConnection& owner_;
  const std::function<void()> on_arrival_;
  const dds_topic_descriptor_t& type_;
  const std::size_t depth_;
  std::deque<Bytes> waiting_;  // guarded by the owner's mutex
  const std::uint32_t id_;     // last: from then on samples arrive
};

class HostConnection::Service final : public ServiceServer {
 public:
  Service(HostConnection& owner, std::size_t node, const ServiceSpec& spec, Handler handler)
      : owner_(owner),
        request_(*spec.request),
        response_(*spec.response),
        handler_(std::move(handler)),
        id_(owner.AddEndpoint({.kind = MadeKind::kService,
                               .node = static_cast<std::uint32_t>(node),
                               .name = spec.name,
                               .type = request_.m_typename,
                               .response_type = response_.m_typename,
                               .qos = spec.qos},
                              owner.services_, this)) {}
  ~Service() override {
    owner_.Remove(id_);
    // A handler that has begun ends before its service does; none begins after Remove.
    const std::lock_guard until_handled(owner_.executing_);
  }

  void Start() override {
    const std::lock_guard lock(owner_.mutex_);
    is_started_ = true;
    for (Request& request : std::exchange(early_, {})) owner_.requests_.push_back(std::move(request));
    owner_.wake_.Signal();
  }

  bool Respond(const void* response) noexcept override {
    try {
      const Bytes bytes = wire::SampleToCdr(response, response_);
      if (bytes.size() > Link::kMaxContent) return false;
      const std::lock_guard lock(owner_.mutex_);
      if (!owner_.link_ || !owner_.services_.contains(id_)) return false;
      owner_.Send(LinkKind::kWrite, id_, bytes);
      owner_.FlushNow();
      return true;
    } catch (const std::bad_alloc&) {
      return false;
    }
  }

  // REQUIRES: the owner's mutex is held.
  void Add(Request request) {
    std::deque<Request>& waiting = is_started_ ? owner_.requests_ : early_;
    waiting.push_back(std::move(request));
    if (waiting.size() > kMaxRequests) waiting.pop_front();
  }

  // REQUIRES: executing_ is held, and mutex_ is not.
  void Execute(const Request& request) const {
    const wire::UntypedSample sample(request_);
    if (wire::SampleFromCdr(request.bytes, request_, sample.data()).ok()) handler_(sample.data(), request.is_repeated);
  }

 private:
  HostConnection& owner_;
  const dds_topic_descriptor_t& request_;
  const dds_topic_descriptor_t& response_;
  const Handler handler_;
  bool is_started_ = false;    // guarded by the owner's mutex, as the one below
  std::deque<Request> early_;  // that have arrived before Start
  const std::uint32_t id_;     // last: from then on requests arrive
};

HostConnection::HostConnection(Distribution distribution, std::string socket, std::uint32_t domain, Sending sending)
    : RosConnection(distribution), socket_(std::move(socket)), domain_(domain), sending_(sending), thread_([this] {
        Run();
      }) {}

HostConnection::~HostConnection() {
  stop_ = true;
  wake_.Signal();
  thread_.join();
}

std::size_t HostConnection::AddNode(const std::string& node_namespace, const std::string& name) {
  const std::lock_guard lock(mutex_);
  return Make({.kind = MadeKind::kNode, .name = (node_namespace == "/" ? "" : node_namespace) + "/" + name});
}

std::unique_ptr<TopicWriter> HostConnection::MakeWriter(std::size_t node, const TopicSpec& spec) {
  return std::make_unique<Writer>(*this, node, spec);
}

std::unique_ptr<TopicReader> HostConnection::MakeReader(std::size_t node, const TopicSpec& spec, Part part,
                                                        std::function<void()> on_arrival) {
  return std::make_unique<Reader>(*this, node, spec, part, std::move(on_arrival));
}

std::unique_ptr<ServiceServer> HostConnection::MakeService(std::size_t node, const ServiceSpec& spec,
                                                           ServiceServer::Handler handler) {
  return std::make_unique<Service>(*this, node, spec, std::move(handler));
}

void HostConnection::Announce() {
  const std::lock_guard lock(mutex_);
  announced_ = true;
  Send(LinkKind::kAnnounce, 0);
  FlushNow();
}

void HostConnection::WatchDistributions() {
  const std::lock_guard lock(mutex_);
  Make({.kind = MadeKind::kDistributionWatch});
}

std::vector<std::string> HostConnection::DrainMismatches() {
  const std::lock_guard lock(mutex_);
  return std::exchange(mismatches_, {});
}

void HostConnection::Receive() {
  const std::lock_guard lock(mutex_);
  ReceiveNow();
}

void HostConnection::Flush() {
  const std::lock_guard lock(mutex_);
  FlushNow();
}

void HostConnection::AwaitSent() {
  const Clock::time_point end = Clock::now() + kMaxSend;
  for (;;) {
    const std::lock_guard lock(mutex_);
    if (!link_ || broken_) return;
    if (link_->pending() <= kMaxPending) SendHeld();
    FlushNow();
    if (broken_ || (link_->pending() == 0 && held_.empty()) || Clock::now() >= end) return;
    pollfd waited = {link_->descriptor(), POLLOUT, 0};
    poll(&waited, 1, kSendMilliseconds);
  }
}

void HostConnection::AwaitSettled() {
  const Clock::time_point begin = Clock::now();
  std::unique_lock lock(mutex_);
  is_settling_ = true;
  Send(LinkKind::kSettle, kNothing);
  FlushNow();
  while (is_settling_) {
    const Clock::time_point end =
        begin + (link_ ? Clock::duration(kMaxSettle) : Clock::duration(kMaxSettleWithoutProgram));
    if (Clock::now() >= end) return;
    settled_.wait_until(lock, end);
  }
}

void HostConnection::ConfirmShown() {
  const std::lock_guard lock(mutex_);
  Send(LinkKind::kShown, kNothing);
  FlushNow();
}

void HostConnection::WatchTopics(std::function<void()> changed) {
  const std::lock_guard lock(changing_);
  changed_ = std::move(changed);
}

std::uint32_t HostConnection::Watch(const std::string& watched) {
  const std::lock_guard lock(mutex_);
  const std::uint32_t watch = Make({.kind = MadeKind::kWatch, .name = watched});
  FlushNow();
  return watch;
}

void HostConnection::Unwatch(std::uint32_t watch) {
  Remove(watch);
  const std::lock_guard lock(mutex_);
  watched_.arrived.erase(watch);
  watched_.arrived_before.erase(watch);
  watched_.timed.erase(watch);
  FlushNow();
}

void HostConnection::Arm(const std::string& text) {
  const std::lock_guard lock(mutex_);
  arm_ = text;
  Send(LinkKind::kArm, 0, BytesOf(text));
  FlushNow();
}

void HostConnection::Show() {
  const std::lock_guard lock(mutex_);
  Send(LinkKind::kShow, 0);
  FlushNow();
}

void HostConnection::Collect() {
  const std::lock_guard lock(mutex_);
  Send(LinkKind::kCollect, 0);
}

void HostConnection::Tell(const TopicWriter& writer, const void* header, const TopicReader& answers,
                          const std::set<std::uint32_t>& awaited) {
  const auto& of_connection = static_cast<const Writer&>(writer);
  const std::lock_guard lock(mutex_);
  newest_tell_ = {of_connection.id(), wire::SampleToCdr(header, of_connection.type())};
  newest_awaited_ = ToBytes(awaited);
  answers_ = static_cast<const Reader&>(answers).id();
  ++tells_;
  watched_.is_told = false;
  watched_.held_for.reset();
  watched_.calling.clear();
  SendTell();
  FlushNow();
}

void HostConnection::Await(const std::set<std::uint32_t>& awaited) {
  const std::lock_guard lock(mutex_);
  newest_awaited_ = ToBytes(awaited);
  Send(LinkKind::kAwait, 0, newest_awaited_);
  FlushNow();
}

void HostConnection::SendTell() {
  Send(LinkKind::kAwait, 0, newest_awaited_);
  Send(LinkKind::kTell, newest_tell_.first, newest_tell_.second);
}

HostConnection::Watched HostConnection::watched() {
  const std::lock_guard lock(mutex_);
  return watched_;
}

void HostConnection::Run() {
  int delay = kFirstDelay;
  while (!stop_) {
    bool is_open = false;
    try {
      is_open = Open();
    } catch (const std::bad_alloc&) {  // it is opened after the delay
      const std::lock_guard lock(mutex_);
      Close();
    }
    if (is_open) {
      const Clock::time_point opened = Clock::now();
      Serve();
      // One that is refused again and again is tried ever more rarely.
      if (Clock::now() - opened > kHealthyTime) delay = kFirstDelay;
    }
    if (stop_) return;
    pollfd waited = {wake_.descriptor(), POLLIN, 0};
    poll(&waited, 1, delay);
    wake_.Clear();
    delay = std::min(2 * delay, kMaxDelay);
  }
}

void HostConnection::Serve() {
  while (!stop_) {
    pollfd waited[] = {{wake_.descriptor(), POLLIN, 0}, {link_->descriptor(), POLLIN, 0}};
    if (link_->pending() > 0) waited[1].events |= POLLOUT;
    poll(waited, 2, -1);
    wake_.Clear();
    try {
      {
        const std::lock_guard lock(mutex_);
        ReceiveNow();
        if (link_->pending() <= kMaxPending) SendHeld();
        if (!link_->Flush()) broken_ = true;  // the rest follows at POLLOUT
        if (broken_) return Close();
      }
      ExecuteRequests();
      ReportArrivals();
    } catch (const std::bad_alloc&) {
      const std::lock_guard lock(mutex_);
      return Close();
    }
  }
}

bool HostConnection::Open() {
  const Result<int> connected = Connect(socket_);
  if (!connected.ok()) return false;
  auto link = std::make_unique<Link>(connected.value());
  const std::lock_guard lock(mutex_);
  link_ = std::move(link);
  broken_ = false;
  must_show_again_ = false;
  watched_.timed.clear();
  watched_.held_for.reset();
  watched_.calling.clear();
  Send(LinkKind::kHello, 0, BytesOf(ToText(HelloText{VersionText(), domain_, sending_ == Sending::kByFlush})));
  // In the sequence of making: nodes before their endpoints.
  for (const Made& made : made_) Send(LinkKind::kMake, made.id, BytesOf(made.text));
  for (const auto& [id, bytes] : latched_) Send(LinkKind::kWrite, id, bytes);
  if (announced_) Send(LinkKind::kAnnounce, 0);
  if (is_settling_) Send(LinkKind::kSettle, kNothing);
  settled_.notify_all();  // the limit is another one
  if (!arm_.empty()) Send(LinkKind::kArm, 0, BytesOf(arm_));
  // Answers to those before are lost with the program; the newest stands for them.
  tells_ = std::min(tells_, 1);
  if (tells_ > 0) {
    Send(LinkKind::kCollect, 0);
    SendTell();
  }
  FlushNow();
  return true;
}

void HostConnection::Close() {
  link_.reset();
  // Without readers, until the next program says otherwise.
  for (const auto& [id, writer] : writers_) writer->React({});
}

void HostConnection::ExecuteRequests() {
  for (;;) {
    const std::lock_guard executing(executing_);
    std::unique_lock lock(mutex_);
    if (requests_.empty()) return;
    const Request request = std::move(requests_.front());
    requests_.pop_front();
    // Its service may have ended while the request waited.
    const auto found = services_.find(request.service);
    if (found == services_.end()) continue;
    const Service& service = *found->second;
    lock.unlock();
    service.Execute(request);
  }
}

void HostConnection::ReportArrivals() {
  {
    const std::lock_guard lock(mutex_);
    if (!std::exchange(has_arrived_, false)) return;
  }
  const std::lock_guard lock(changing_);
  if (changed_) changed_();
}

void HostConnection::Send(LinkKind kind, std::uint32_t id, std::span<const std::byte> content) {
  if (link_) link_->Add(kind, id, content);
}

void HostConnection::SendHeld() {
  for (const auto& [id, bytes] : held_) Send(LinkKind::kWrite, id, bytes);
  held_.clear();
}

std::uint32_t HostConnection::Make(const MadeText& made) {
  const std::uint32_t id = next_id_++;
  made_.push_back({id, ToText(made)});
  Send(LinkKind::kMake, id, BytesOf(made_.back().text));
  return id;
}

template <typename Endpoint>
std::uint32_t HostConnection::AddEndpoint(const MadeText& made, std::map<std::uint32_t, Endpoint*>& endpoints,
                                          Endpoint* endpoint) {
  const std::lock_guard lock(mutex_);
  const std::uint32_t id = Make(made);
  endpoints[id] = endpoint;
  if (sending_ == Sending::kAtOnce) FlushNow();  // nothing else may be sent for long
  return id;
}

void HostConnection::Remove(std::uint32_t id) {
  const std::lock_guard lock(mutex_);
  writers_.erase(id);
  readers_.erase(id);
  services_.erase(id);
  latched_.erase(id);
  held_.erase(id);
  std::erase_if(made_, [id](const Made& made) { return made.id == id; });
  Send(LinkKind::kRemove, id);
  if (sending_ == Sending::kAtOnce) FlushNow();
}

void HostConnection::Process(const LinkMessage& message) {
  has_arrived_ = true;
  switch (message.kind) {
    case LinkKind::kMatched: {
      if (const auto reader = readers_.find(message.id); reader != readers_.end()) return reader->second->Miss();
      const auto writer = writers_.find(message.id);
      MatchedContent content;
      if (writer == writers_.end() || message.content.size() != sizeof content) return;
      std::memcpy(&content, message.content.data(), sizeof content);
      return writer->second->React(content);
    }
    case LinkKind::kSample:
    case LinkKind::kRepeated: {
      if (const auto reader = readers_.find(message.id); reader != readers_.end()) {
        return reader->second->Add(message.content);
      }
      const auto service = services_.find(message.id);
      if (service == services_.end()) return;
      const bool is_repeated = message.kind == LinkKind::kRepeated;
      service->second->Add({message.id, is_repeated, Bytes(message.content.begin(), message.content.end())});
      return wake_.Signal();
    }
    case LinkKind::kMismatch:
      mismatches_.emplace_back(reinterpret_cast<const char*>(message.content.data()), message.content.size());
      return;
    case LinkKind::kArrived:
    case LinkKind::kTimed:
    case LinkKind::kTold:
    case LinkKind::kHeld:
    case LinkKind::kCalling:
      return ProcessWatched(message);
    case LinkKind::kShowAgain:
      must_show_again_ = true;
      return;
    case LinkKind::kSettled:
      is_settling_ = false;
      settled_.notify_all();
      return;
    default:
      return;
  }
}

void HostConnection::ProcessWatched(const LinkMessage& message) {
  const std::string text(reinterpret_cast<const char*>(message.content.data()), message.content.size());
  if (message.kind == LinkKind::kTold) {
    if (writers_.contains(message.id)) latched_[message.id] = Bytes(message.content.begin(), message.content.end());
    watched_.is_told = --tells_ <= 0;
    watched_.held_for.reset();
    if (const auto found = readers_.find(answers_); found != readers_.end()) found->second->Forget();
    return;
  }
  if (message.kind == LinkKind::kHeld) {
    watched_.held_for = ToIds(message.content);
    return;
  }
  if (message.kind == LinkKind::kCalling) {
    watched_.calling = ToIds(message.content);
    return;
  }
  if (message.kind == LinkKind::kTimed) {
    if (text == kNotTimed) {
      watched_.timed.erase(message.id);
    } else {
      watched_.timed.insert(message.id);
    }
    return;
  }
  if (watched_.armed != text) {
    watched_.armed_before = std::exchange(watched_.armed, text);
    watched_.arrived_before = std::exchange(watched_.arrived, {});
  }
  if (message.id != kNothing) watched_.arrived.insert(message.id);
}

void HostConnection::ReceiveNow() {
  if (!link_ || broken_) return;
  // Either thread may find the end; the connection's own thread closes, since it polls the descriptor.
  if (link_->Receive([this](const LinkMessage& message) { Process(message); })) return;
  broken_ = true;
  wake_.Signal();
}

void HostConnection::FlushNow() {
  if (!link_ || broken_) return;
  if (!link_->Flush()) broken_ = true;
  if (broken_ || link_->pending() > 0) wake_.Signal();
}

}  // namespace troupe::ros
