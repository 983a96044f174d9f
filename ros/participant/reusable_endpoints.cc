#include "ros/participant/reusable_endpoints.h"

#include <fmt/format.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <thread>
#include <utility>

#include "common/base/identity.h"
#include "ros/link/host_program.h"
#include "transport/wire/cdr.h"

namespace troupe::ros {
namespace {

constexpr std::size_t kMaxWaiting = 100;  // requests to a service without an agent, or without a response

// A process that dies again and again is started ever more rarely, but each time: clients wait for it.
constexpr auto kFirstDelay = std::chrono::milliseconds(100);
constexpr auto kMaxDelay = std::chrono::milliseconds(30'000);
constexpr auto kHealthyTime = std::chrono::seconds(60);  // after this the delays start again
constexpr auto kStopTime = std::chrono::seconds(3);
constexpr std::size_t kMaxResponses = std::size_t{64} << 20;  // bytes of responses that wait for it

std::vector<std::string> ArgumentsOf(const RosNetwork& network) {
  std::vector<std::string> arguments = NetworkArguments(network);
  arguments.emplace_back(FastDdsSide::kFlag);
  return arguments;
}

}  // namespace

ReusableWriter::ReusableWriter(RosParticipant& participant, const TopicSpec& spec)
    : participant_(participant),
      topic_(spec.topic),
      type_(*spec.type),
      is_volatile_(spec.qos.kind == TopicQos::Kind::kStream),
      writer_(participant, spec, [this](bool wanted, bool is_new) {
        const std::lock_guard lock(mutex_);
        if (sink_) return sink_(wanted, is_new);
        has_new_ = has_new_ || is_new;
      }) {}

void ReusableWriter::Attach(std::size_t node, Sink sink) {
  participant_.AddWriter(node, writer_.handle());
  const std::lock_guard lock(mutex_);
  sink_ = std::move(sink);
  // Readers of the agent before have its samples.
  sink_(writer_.wanted(), std::exchange(has_new_, false) && writer_.wanted());
}

void ReusableWriter::Detach() {
  participant_.RemoveEndpoint(writer_.handle());
  {
    const std::lock_guard lock(mutex_);
    sink_ = {};
  }
  if (is_volatile_) return;
  const wire::UntypedSample none(type_);
  // Late readers must not get the latched sample of an agent that has ended.
  dds_dispose(writer_.handle(), none.data());
}

ReusableReader::ReusableReader(RosParticipant& participant, const TopicSpec& spec, Part part)
    : participant_(participant),
      topic_(spec.topic),
      type_(*spec.type),
      depth_(static_cast<std::size_t>(spec.qos.depth)),
      part_(part),
      reader_(participant, spec, part,
              {[this] { Pass(); },
               [this] {
                 const std::lock_guard lock(mutex_);
                 if (sink_) sink_->on_missed_writer();
               }}) {}

void ReusableReader::Attach(std::size_t node, Sink sink) {
  participant_.AddReader(node, reader_.handle(), part_ == Part::kReliableReader);
  {
    const std::lock_guard lock(mutex_);
    // Samples for the agent before, such as a command from before a reset, are not for this one.
    if (std::exchange(used_, true) && round_ == 0) reader_.Drain([](const void*) {});
    sink_ = std::move(sink);
    for (Kept& kept : kept_) sink_->on_sample(kept.sample, std::exchange(kept.was_passed, true));
    if (reader_.missed_writer()) sink_->on_missed_writer();
  }
  Pass();
}

void ReusableReader::Detach() {
  participant_.RemoveEndpoint(reader_.handle());
  const std::lock_guard lock(mutex_);
  sink_.reset();
}

void ReusableReader::BeginRound(bool is_new_run) {
  const std::lock_guard lock(mutex_);
  ++round_;
  std::erase_if(kept_, [&](const Kept& kept) { return is_new_run || kept.round + 1 < round_; });
  for (Kept& kept : kept_) kept.was_passed = true;
  if (is_new_run && !sink_) reader_.Drain([](const void*) {});
}

void ReusableReader::Pass() {
  const std::lock_guard lock(mutex_);
  if (!sink_ && round_ == 0) return;
  reader_.Drain([this](const void* sample) {
    std::vector<std::byte> bytes = wire::SampleToCdr(sample, type_);
    if (sink_) sink_->on_sample(bytes, false);
    if (round_ == 0) return;
    kept_.push_back({round_, sink_.has_value(), std::move(bytes)});
    if (kept_.size() > depth_) kept_.pop_front();
  });
}

ReusableService::ReusableService(RosParticipant& participant, const ServiceSpec& spec, std::uint32_t domain,
                                 FastDdsSide* fast_dds, bool on_cyclone)
    : participant_(participant), spec_(spec), request_(*spec.request), response_(*spec.response), fast_dds_(fast_dds) {
  if (on_cyclone) ServeCyclone();
  if (fast_dds_ == nullptr) return;
  fast_id_ = fast_dds_->Add({.kind = MadeKind::kService,
                             .name = spec.name,
                             .type = request_.m_typename,
                             .response_type = response_.m_typename,
                             .domain = domain},
                            {[this](std::span<const std::byte> request) { PassOfFastDds(request); },
                             [this](const ServedContent& served) { ListServed(served); }});
}

ReusableService::~ReusableService() {
  if (fast_dds_ != nullptr) fast_dds_->Remove(fast_id_);
}

// A side that was started again has other endpoints.
void ReusableService::ListServed(const ServedContent& served) {
  Unlist();
  served_ = served;
  List();
}

void ReusableService::ServeCyclone() {
  if (cyclone_) return;
  Unlist();
  cyclone_.emplace(participant_, spec_, [this](const void* request, dds_instance_handle_t caller) {
    Pass(wire::SampleToCdr(request, request_), caller);
  });
  List();
  cyclone_->Start();
}

// Tools of either implementation know both kinds.
void ReusableService::List() {
  if (!node_) return;
  if (cyclone_) {
    participant_.AddReader(*node_, cyclone_->request_reader());
    participant_.AddWriter(*node_, cyclone_->response_writer());
  } else if (served_) {
    participant_.AddForeignService(*node_, served_->reader, served_->writer);
  }
}

void ReusableService::Unlist() {
  if (cyclone_) {
    participant_.RemoveEndpoint(cyclone_->request_reader());
    participant_.RemoveEndpoint(cyclone_->response_writer());
  } else if (served_) {
    participant_.RemoveForeignService(served_->reader, served_->writer);
  }
}

void ReusableService::Attach(std::size_t node, Sink sink) {
  node_ = node;
  List();
  const std::lock_guard lock(mutex_);
  sink_ = std::move(sink);
  for (const auto& [caller, request] : unanswered_) sink_(request, true, DDS_HANDLE_NIL);
  for (Waiting& waiting : std::exchange(waiting_, {})) {
    sink_(waiting.request, false, waiting.caller);
    KeepUnanswered(std::move(waiting.request));
  }
}

void ReusableService::Detach() {
  Unlist();
  node_.reset();
  StopPassing();
}

void ReusableService::StopPassing() {
  const std::lock_guard lock(mutex_);
  sink_ = {};
  returned_ = 0;
}

void ReusableService::Return(Bytes request, dds_instance_handle_t caller) {
  const std::lock_guard lock(mutex_);
  const auto kept = std::find_if(unanswered_.begin(), unanswered_.end(),
                                 [&request](const auto& unanswered) { return unanswered.second == request; });
  if (kept == unanswered_.end()) return;  // too many were not answered
  unanswered_.erase(kept);
  const auto next = waiting_.begin() + static_cast<std::ptrdiff_t>(std::min(returned_++, waiting_.size()));
  waiting_.insert(next, Waiting{std::move(request), caller});
}

void ReusableService::Pass(std::span<const std::byte> request, dds_instance_handle_t caller) {
  const std::lock_guard lock(mutex_);
  Bytes bytes(request.begin(), request.end());
  if (!sink_) {
    waiting_.push_back({std::move(bytes), caller});
    if (waiting_.size() > kMaxWaiting) waiting_.pop_front();
    return;
  }
  sink_(request, false, caller);
  KeepUnanswered(std::move(bytes));
}

void ReusableService::KeepUnanswered(Bytes request) {
  const wire::UntypedSample sample(request_);
  if (!wire::SampleFromCdr(request, request_, sample.data()).ok()) return;
  unanswered_.emplace_back(*static_cast<const CallHeader*>(sample.data()), std::move(request));
  if (unanswered_.size() > kMaxWaiting) unanswered_.pop_front();
}

// Fast DDS pads samples to a multiple of 4 bytes, without stating it in their fourth byte. Any bytes are safe.
void ReusableService::PassOfFastDds(std::span<const std::byte> request) {
  constexpr std::size_t kPaddingAt = 3;
  if (request.size() <= kPaddingAt) return;
  std::vector<std::byte> bytes(request.begin(), request.end());
  for (unsigned padding = 0; padding <= 3; ++padding) {
    bytes[kPaddingAt] = static_cast<std::byte>(padding);
    const wire::UntypedSample sample(request_);
    if (wire::SampleFromCdr(bytes, request_, sample.data()).ok()) return Pass(bytes);
  }
}

bool ReusableService::Respond(const void* response, std::span<const std::byte> bytes) {
  const CallHeader& caller = *static_cast<const CallHeader*>(response);
  {
    const std::lock_guard lock(mutex_);
    std::erase_if(unanswered_, [&caller](const auto& request) { return request.first == caller; });
  }
  if (fast_dds_ != nullptr && fast_dds_->Respond(fast_id_, caller.client_guid, bytes)) return true;
  return !cyclone_ || cyclone_->Respond(response);
}

FastDdsSide::FastDdsSide(const RosNetwork& network, std::function<void(const std::string&)> report)
    : arguments_(ArgumentsOf(network)), report_(std::move(report)) {
  Start();
}

FastDdsSide::~FastDdsSide() {
  link_.reset();
  const Clock::time_point end = Clock::now() + kStopTime;
  while (child_ > 0 && waitpid(child_, nullptr, WNOHANG) == 0) {
    // It ends at the end of its link; one that hangs must not hold up the run's end.
    if (Clock::now() > end) kill(child_, SIGKILL);
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
}

void FastDdsSide::Start() {
  due_.reset();
  started_ = Clock::now();
  delay_ = std::clamp(2 * delay_, kFirstDelay, kMaxDelay);
  int ends[2] = {-1, -1};
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0, ends) != 0) {
    due_ = Clock::now() + delay_;
    return;
  }
  std::error_code failure;
  const Result<pid_t> child =
      StartProgram(std::filesystem::read_symlink("/proc/self/exe", failure), arguments_, ends[1]);
  close(ends[1]);
  link_ = std::make_unique<Link>(ends[0]);
  if (!child.ok()) {
    report_(child.error().message);
    link_.reset();
    due_ = Clock::now() + delay_;
    return;
  }
  child_ = child.value();
  // Responses to calls of the process before must not reach callers of this one: numbers begin again.
  guid_ = MakeRandomId();
  Send(LinkKind::kHello, 0, std::as_bytes(std::span(&guid_, 1)));
  for (const auto& [id, service] : services_) {
    Send(LinkKind::kMake, id, std::as_bytes(std::span(service.text)));
  }
}

void FastDdsSide::Send(LinkKind kind, std::uint32_t id, std::span<const std::byte> content) {
  if (!link_ || (kind == LinkKind::kWrite && link_->pending() > kMaxResponses)) return;
  link_->Add(kind, id, content);
  link_->Flush();  // an end is noticed by Process
}

std::uint32_t FastDdsSide::Add(const MadeText& service, Sink sink) {
  const std::uint32_t id = next_service_++;
  const std::string text = ToText(service);
  services_[id] = {text, std::move(sink)};
  Send(LinkKind::kMake, id, std::as_bytes(std::span(text)));
  return id;
}

void FastDdsSide::Remove(std::uint32_t service) {
  services_.erase(service);
  Send(LinkKind::kRemove, service);
}

bool FastDdsSide::Respond(std::uint32_t service, std::uint64_t client_guid, std::span<const std::byte> response) {
  if (client_guid != guid_) return false;
  Send(LinkKind::kWrite, service, response);
  return true;
}

bool FastDdsSide::Process() {
  if (due_ && Clock::now() >= *due_) Start();
  if (!link_) return false;
  bool served = false;
  const auto receive = [&](const LinkMessage& message) {
    const auto found = services_.find(message.id);
    if (found == services_.end()) return;
    if (message.kind == LinkKind::kSample) found->second.sink.on_request(message.content);
    ServedContent content;
    if (message.kind != LinkKind::kServed || message.content.size() != sizeof content) return;
    std::memcpy(&content, message.content.data(), sizeof content);
    found->second.sink.on_served(content);
    served = true;
  };
  if (link_->Receive(receive) && link_->Flush()) return served;
  link_.reset();
  int status = 0;
  kill(child_, SIGKILL);  // one that has only closed its link
  waitpid(child_, &status, 0);
  report_(fmt::format("the Fast DDS side (process {}) {}; it is started again", child_, ToText(status)));
  child_ = 0;
  if (Clock::now() - started_ > kHealthyTime) delay_ = {};
  due_ = Clock::now() + std::max(delay_, kFirstDelay);
  return served;
}

}  // namespace troupe::ros
