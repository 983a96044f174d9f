#include "ros/participant/fast_dds_side.h"

#include <fmt/format.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <thread>
#include <utility>

#include "common/base/random_id.h"
#include "ros/link/host_program.h"

namespace troupe::ros {
namespace {

// A process that dies again and again is started ever more rarely, but each time: clients wait for it.
constexpr auto kFirstDelay = std::chrono::milliseconds(100);
constexpr auto kLongestDelay = std::chrono::milliseconds(30'000);
constexpr auto kHealthyTime = std::chrono::seconds(60);  // after this the delays start anew
constexpr auto kStopTime = std::chrono::seconds(3);
constexpr std::size_t kMostResponses = std::size_t{64} << 20;  // bytes of responses that wait for it

std::vector<std::string> ArgumentsOf(const RosNetwork& network) {
  std::vector<std::string> arguments = NetworkArguments(network);
  arguments.emplace_back(FastDdsSide::kFlag);
  return arguments;
}

}  // namespace

FastDdsSide::FastDdsSide(const RosNetwork& network, std::function<void(const std::string&)> report)
    : arguments_(ArgumentsOf(network)), report_(std::move(report)) {
  Start();
}

FastDdsSide::~FastDdsSide() {
  link_.reset();
  const Clock::time_point end = Clock::now() + kStopTime;
  while (child_ > 0 && waitpid(child_, nullptr, WNOHANG) == 0) {
    if (Clock::now() > end) kill(child_, SIGKILL);
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
}

void FastDdsSide::Start() {
  due_.reset();
  started_ = Clock::now();
  delay_ = std::clamp(2 * delay_, kFirstDelay, kLongestDelay);
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
  guid_ = MakeRandomId();
  Send(LinkKind::kHello, 0, std::as_bytes(std::span(&guid_, 1)));
  for (const auto& [id, service] : services_) {
    Send(LinkKind::kMakeService, id, std::as_bytes(std::span(service.text)));
  }
}

void FastDdsSide::Send(LinkKind kind, std::uint32_t id, std::span<const std::byte> content) {
  if (!link_ || (kind == LinkKind::kRespond && link_->pending() > kMostResponses)) return;
  link_->Add(kind, id, content);
  link_->Flush();  // an end is noticed by Process
}

std::uint32_t FastDdsSide::Add(const ServiceText& service, OnRequest on_request) {
  const std::uint32_t id = next_service_++;
  const std::string text = ToText(service);
  services_[id] = {text, std::move(on_request)};
  Send(LinkKind::kMakeService, id, std::as_bytes(std::span(text)));
  return id;
}

void FastDdsSide::Remove(std::uint32_t service) {
  services_.erase(service);
  Send(LinkKind::kRemove, service);
}

bool FastDdsSide::Respond(std::uint32_t service, std::uint64_t client_guid, std::span<const std::byte> response) {
  if (client_guid != guid_) return false;
  Send(LinkKind::kRespond, service, response);
  return true;
}

void FastDdsSide::Process() {
  if (due_ && Clock::now() >= *due_) Start();
  if (!link_) return;
  const auto receive = [this](const LinkMessage& message) {
    const auto found = services_.find(message.id);
    if (message.kind == LinkKind::kRequest && found != services_.end()) found->second.on_request(message.content);
  };
  if (link_->Receive(receive) && link_->Flush()) return;
  link_.reset();
  int status = 0;
  kill(child_, SIGKILL);  // one that has only closed its link
  waitpid(child_, &status, 0);
  report_(fmt::format("the Fast DDS side (process {}) {}; it is started again", child_, ToText(status)));
  child_ = 0;
  if (Clock::now() - started_ > kHealthyTime) delay_ = {};
  due_ = Clock::now() + std::max(delay_, kFirstDelay);
}

}  // namespace troupe::ros
