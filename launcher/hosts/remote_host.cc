#include "launcher/hosts/remote_host.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <string.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <span>
#include <string_view>

#include "common/base/file.h"
#include "common/base/identity.h"
#include "common/base/json.h"
#include "common/base/system_error.h"
#include "common/base/text.h"

namespace troupe {
namespace {

using Clock = std::chrono::steady_clock;

// BatchMode: a launcher cannot type a password. The ServerAlive options detect a dead network, after a minute: as long
// do agents wait for the world service, so that they outlive a shorter interruption with all their memory.
constexpr const char* kDefaultStart =
    "ssh -T -o BatchMode=yes -o ConnectTimeout=10 -o ServerAliveInterval=5 -o ServerAliveCountMax=12 {address} "
    "{command_text}";

constexpr std::size_t kMaxBytesOfKeys = 1'000'000;            // of a file
constexpr auto kDisconnectTimeout = std::chrono::seconds(3);  // for the end of the connection
constexpr auto kFetchTimeout = std::chrono::seconds(30);      // between two messages while a file is fetched
constexpr auto kFetchPoll = std::chrono::milliseconds(100);   // longest wait until progress is reported

// The programs are expected in the same folder as here, unless the scenario names another.
std::string ConnectingCommand(const HostSettings& host) {
  std::string programs = host.programs;
  if (programs.empty()) {
    Result<std::string> here = FindProgram("troupe");
    if (here.ok()) programs = std::filesystem::path(here.value()).parent_path().string();
  }
  const std::string command = ShellQuoted(std::vector<std::string>{programs + "/troupe", "host"});
  return FillIn(host.start.empty() ? kDefaultStart : host.start, {{"command", command},
                                                                  {"command_text", ShellQuoted(command)},
                                                                  {"address", ShellQuoted(host.address)},
                                                                  {"name", ShellQuoted(host.name)}});
}

constexpr std::chrono::milliseconds kForever(-1);

// Until one of `readable` can be read, or `writable` can be written; a negative descriptor is not waited for.
void WaitFor(const std::vector<int>& readable, std::chrono::milliseconds timeout, int writable = -1) {
  std::vector<pollfd> waited = {{writable, POLLOUT, 0}};
  for (int descriptor : readable) waited.push_back({descriptor, POLLIN, 0});
  poll(waited.data(), waited.size(), static_cast<int>(timeout.count()));
}

}  // namespace

class RemoteHost::RemoteChild : public Child {
 public:
  RemoteChild(RemoteHost& host, int id, std::shared_ptr<State> state)
      : host_(host), id_(id), state_(std::move(state)) {}
  pid_t pid() const override { return state_->pid; }
  const std::optional<ProcessEnd>& end() const override { return state_->end; }
  bool Poll() override { return state_->end && !std::exchange(state_->reported, true); }
  void Signal(int signal) override {
    if (!state_->end) host_.Send(ToLine({{"signal", id_}, {"number", signal}}));
  }
  void Tell(const std::string& line) override {
    if (!state_->end) host_.Send(ToLine({{"tell", id_}, {"line", line}}));
  }
  // Counted as ended at once: the launcher's own end must not wait for a network.
  void Kill() override {
    Signal(SIGKILL);
    // The host may be unreachable; it kills the process when the connection ends.
    if (!state_->end) state_->end = ProcessEnd{128 + SIGKILL, SIGKILL, 0.0};
  }

 private:
  RemoteHost& host_;
  const int id_;
  const std::shared_ptr<State> state_;
};

RemoteHost::RemoteHost(const HostSettings& settings, std::string command, std::string run)
    : settings_(settings), command_(std::move(command)), run_(std::move(run)) {}

Result<std::unique_ptr<RemoteHost>> RemoteHost::Connect(const HostSettings& settings, const std::string& run) {
  std::unique_ptr<RemoteHost> host(new RemoteHost(settings, ConnectingCommand(settings), run));
  if (Status failure = host->Open(); !failure.ok()) return failure.error();
  return host;
}

Status RemoteHost::Open() {
  messages_ = std::make_unique<LinePipe>();
  errors_ = std::make_unique<LinePipe>();
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) return SystemError("cannot make a pipe");
  requests_ = ends[1];
  // Writing must not block: both sides could wait for each other with full pipes (Send reads meanwhile).
  fcntl(requests_, F_SETFL, O_NONBLOCK);
  Result<Process> connection =
      Process::Start({"/bin/sh", "-c", command_}, {ends[0], messages_->writing_end(), errors_->writing_end()});
  close(ends[0]);
  messages_->CloseWritingEnd();
  errors_->CloseWritingEnd();
  if (!connection.ok()) return connection.error();
  connection_ = std::move(connection).value();
  Send(ToLine({{"run", run_}}));
  return Status();
}

void RemoteHost::Reconnect() {
  if (requests_ >= 0) close(std::exchange(requests_, -1));
  connection_.reset();
  ready_ = lost_ = is_first_ = false;
  pings_ = 0;
  loss_ = Status();
  last_error_line_.clear();
  enclaves_.clear();
  if (Status failure = Open(); !failure.ok()) Lose(failure.error().message);
}

int RemoteHost::Ping() {
  if (!connected()) return 0;
  // One at a time: a host that reads nothing must not fill the pipe to it.
  if (++pings_ == 1) Send(ToLine({{"ping", true}}));
  return pings_ - 1;
}

// The end of its input is the signal to `troupe host`; its last messages are read, since it would block on a full pipe.
RemoteHost::~RemoteHost() {
  if (requests_ >= 0) close(requests_);
  const auto deadline = Clock::now() + kDisconnectTimeout;
  while (connection_ && connection_->running() && !connection_->Poll() && Clock::now() < deadline) {
    WaitFor({messages_->at_end() ? -1 : messages_->reading_end()}, std::chrono::milliseconds(10));
    messages_->Read();
  }
}

void RemoteHost::Send(std::string_view line) {
  while (requests_ >= 0 && !lost_ && !line.empty()) {
    const ssize_t written = write(requests_, line.data(), line.size());
    if (written >= 0) {
      line.remove_prefix(static_cast<std::size_t>(written));
    } else if (errno == EAGAIN) {
      // A host that waits until its messages are read takes no requests.
      WaitFor(descriptors(), kForever, requests_);
      Read();
    } else if (errno != EINTR) {
      close(std::exchange(requests_, -1));
    }
  }
}

// Asynchronous: "started" or "failed" comes later, and a failure is an end with status 127, as of a program that cannot
// be executed.
Result<std::unique_ptr<Child>> RemoteHost::Start(const std::string& program, const std::vector<std::string>& arguments,
                                                 bool reports) {
  if (!connected()) return Failure("host " + name() + ": the connection is lost");
  const int id = static_cast<int>(children_.size());
  auto state = std::make_shared<State>();
  children_[id] = state;
  std::vector<std::string> words = arguments;
  Send(ToLine({{"start", id}, {"program", program}, {"arguments", words}, {"reports", reports}}));
  return std::unique_ptr<Child>(std::make_unique<RemoteChild>(*this, id, std::move(state)));
}

// Once for each connection: the folder of a new connection is empty.
Result<std::string> RemoteHost::PlaceKeys(const std::string& keys, const std::string& enclave) {
  if (enclaves_.insert(enclave).second) {
    std::error_code failure;
    for (const auto& entry : std::filesystem::directory_iterator(std::filesystem::path(keys) / enclave, failure)) {
      const std::filesystem::path path = enclave / entry.path().filename();
      const std::string source = keys / path;
      const Result<std::string> content = ReadWholeFile(source, kMaxBytesOfKeys);
      if (!content.ok()) return Error{{source}, "cannot read: " + content.error().message};
      const std::span<const char> data = content.value();
      Send(ToLine({{"key", path.string()}, {"data", ToHexadecimal(std::as_bytes(data))}}));
    }
    if (failure) return Error{{keys + "/" + enclave}, "cannot read the folder of keys: " + failure.message()};
  }
  return folder_ + "/" + kKeysFolderOfHost;
}

std::vector<int> RemoteHost::descriptors() const {
  std::vector<int> open;
  if (!messages_->at_end()) open.push_back(messages_->reading_end());
  if (!errors_->at_end()) open.push_back(errors_->reading_end());
  return open;
}

void RemoteHost::ReadErrors() {
  for (std::string& line : errors_->Read()) {
    last_error_line_ = line;
    if (is_first_ || ready_) output_.push_back(std::move(line));  // each attempt to connect again would print the same
  }
}

// The end of the messages is the loss of the host; the status of the connecting program tells the reason (ssh: 255).
void RemoteHost::Read() {
  ReadErrors();
  for (const std::string& line : messages_->Read()) ApplyMessage(line);
  if (!messages_->at_end() || lost_) return;
  const auto deadline = Clock::now() + std::chrono::seconds(1);  // the process ends just after its output
  while (!connection_->Poll() && connection_->running() && Clock::now() < deadline) {
    WaitFor({}, std::chrono::milliseconds(5));
  }
  ReadErrors();
  Lose(connection_->end() ? connection_->end()->ToString() : "closed its output");
}

void RemoteHost::ApplyMessage(const std::string& line) {
  const JsonReader message = ReadHostMessage(line);
  if (message.ok()) ApplyMessage(message);
  if (!message.ok()) output_.push_back(line);  // for instance of a login script
}

// The child of a message; null, and an error, for a number that none has.
RemoteHost::State* RemoteHost::ChildIn(const JsonReader& message, const char* key) {
  const auto child = children_.find(message.Get<int>(key));
  if (child != children_.end()) return child->second.get();
  message.FailWithout(key, "the number of a process");
  return nullptr;
}

void RemoteHost::ApplyMessage(const JsonReader& message) {
  if (message.Has("host")) {
    const auto version = message.Get<std::string>("host");
    if (version != VersionText()) {
      return Lose("has version " + version + " of Troupe, expected " + std::string(VersionText()));
    }
    folder_ = message.Get<std::string>("folder");
    programs_ = message.Get<std::string>("programs");
    ready_ = message.ok();
  } else if (message.Has("pong")) {
    pings_ = 0;
  } else if (message.Has("output")) {
    output_.push_back(message.Get<std::string>("output"));
  } else if (message.Has("report")) {
    reports_.push_back(message.Get<std::string>("report"));
  } else if (message.Has("started")) {
    if (State* const child = ChildIn(message, "started")) child->pid = message.Get<pid_t>("pid");
  } else if (message.Has("failed")) {
    output_.push_back("error: " + message.Get<std::string>("message"));
    if (State* const child = ChildIn(message, "failed")) child->end = ProcessEnd{127, 0, 0.0};
  } else if (message.Has("ended")) {
    State* const child = ChildIn(message, "ended");
    const ProcessEnd end{message.Get<int>("exit_code"), message.Get<int>("signal"),
                         message.Get<double>("peak_memory_mib")};
    if (child != nullptr && message.ok() && !child->end) child->end = end;
  } else if (fetch_ && message.Optional<std::string>("file") == fetch_->source) {
    if (message.Has("data")) {
      const std::string data = BytesIn(message, "data");
      fetch_->bytes += data.size();
      if (!WriteAll(fetch_->target, data)) fetch_->error = strerror(errno);
    }
    message.Read("error", fetch_->error);
    fetch_->complete = message.Has("end") || message.Has("error");
  }
}

// All processes there count as ended: the host ends them when it notices (see above).
void RemoteHost::Lose(const std::string& reason) {
  if (std::exchange(lost_, true)) return;
  std::string text =
      "host " + settings_.name + ": " + (ready_ ? "the connection is lost: " : "") + "`" + command_ + "` " + reason;
  if (!ready_)
    text += "; expected the programs of Troupe " + std::string(VersionText()) + " there, and a way to start them";
  if (!ready_ && !last_error_line_.empty()) text += "; its last line: " + last_error_line_;
  loss_ = Error{ready_ ? SourceLocation{} : settings_.where, text, ErrorCode::kFailure};
  for (auto& [id, state] : children_) {
    if (!state->end) state->end = ProcessEnd{255, 0, 0.0};
  }
}

Status RemoteHost::PollLoss() {
  return std::exchange(loss_, Status());
}

// Other messages arrive meanwhile and are kept, so that no line is lost during a copy.
Status RemoteHost::Fetch(const std::string& from, const std::string& to, const FetchProgress& progress) {
  const std::string context = "host " + name() + ": cannot fetch " + from + " to " + to + ": ";
  if (!connected()) return Failure(context + "the connection is lost");
  const int target = open(to.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (target < 0) return Failure(context + strerror(errno));
  fetch_ = FileFetch{.source = from, .target = target, .error = ""};
  Send(ToLine({{"read", from}}));
  auto heard_at = Clock::now();
  std::size_t heard = 0;
  while (!fetch_->complete && fetch_->error.empty()) {
    WaitFor(descriptors(), kFetchPoll);
    Read();
    if (std::exchange(heard, fetch_->bytes) != fetch_->bytes) heard_at = Clock::now();
    if (fetch_->complete) break;
    if (Clock::now() - heard_at >= kFetchTimeout) Lose("has sent no data for 30 s");
    if (lost_) fetch_->error = "the connection is lost";
    if (!progress(fetch_->bytes)) fetch_->error = "stopped";
  }
  std::string error = std::move(fetch_->error);
  fetch_.reset();
  if (close(target) != 0 && error.empty()) error = strerror(errno);
  return error.empty() ? Status() : Failure(context + error);
}

}  // namespace troupe
