#include "ros/link/host_program.h"

#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <exception>
#include <filesystem>
#include <utility>

#include "common/base/identity.h"
#include "ros/link/link.h"

namespace troupe::ros {
namespace {

constexpr const char* kProgram = "ros-participant";
constexpr auto kPoll = std::chrono::milliseconds(2);  // until the program listens, or has ended
// A program that dies again and again is started ever more rarely, but each time: ROS nodes wait for it.
constexpr auto kFirstStartDelay = std::chrono::milliseconds(100);
constexpr auto kMaxStartDelay = std::chrono::milliseconds(30'000);
constexpr auto kHealthyProgram = std::chrono::seconds(60);  // after this the delays start again
constexpr auto kStopTime = std::chrono::seconds(5);
constexpr int kMaxOccupied = 50;  // programs in turn that find the socket in use, although nothing answers there
constexpr int kRefused = 2;       // exit status: the options would be refused again

}  // namespace

std::string SocketOfSession(std::uint32_t simulation_domain, const std::string& session, const RosSecurity& security) {
  const std::string enclave = security.strategy == SecurityStrategy::kOff ? "" : security.enclave;
  return fmt::format("troupe-ros/{}/{}{}", simulation_domain, session, enclave);
}

std::string NewSocketName() {
  return fmt::format("troupe-ros/{:016x}", MakeRandomId());
}

Result<pid_t> StartProgram(const std::string& path, const std::vector<std::string>& arguments, int descriptor) {
  std::vector<std::string> words = arguments;
  words.insert(words.begin(), path);
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawnattr_t attributes;
  posix_spawn_file_actions_init(&actions);
  posix_spawnattr_init(&attributes);
  if (descriptor >= 0) posix_spawn_file_actions_adddup2(&actions, descriptor, 3);
  // No descriptor of this process, such as sockets of agents, may stay open in a program that outlives it.
  posix_spawn_file_actions_addclosefrom_np(&actions, descriptor >= 0 ? 4 : 3);
  sigset_t none;
  sigset_t all;
  sigemptyset(&none);
  sigfillset(&all);
  // A blocked or ignored signal would be inherited: the program could not be ended by it.
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setsigdefault(&attributes, &all);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
  pid_t child = 0;
  const int failure = posix_spawn(&child, path.c_str(), &actions, &attributes, pointers.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  posix_spawnattr_destroy(&attributes);
  if (failure != 0) return Failure("cannot start " + path + ": " + std::strerror(failure));
  return child;
}

std::string ToText(int status) {
  if (!WIFSIGNALED(status)) return fmt::format("ended with exit status {}", WEXITSTATUS(status));
  return fmt::format("was killed by signal {} ({})", WTERMSIG(status), strsignal(WTERMSIG(status)));
}

HostProgram::HostProgram(std::string socket, RosNetwork network, AtEnd at_end,
                         std::function<void(const std::string&)> report)
    : socket_(std::move(socket)), network_(std::move(network)), at_end_(at_end), report_(std::move(report)) {}

// Without memory the line is missing, and all else happens.
template <typename MakeText>
void HostProgram::Report(const MakeText& make_text) const {
  try {
    report_(make_text());
  } catch (const std::exception&) {
    return;
  }
}

HostProgram::~HostProgram() {
  stop_ = true;
  wake_.Signal();
  if (thread_.joinable()) thread_.join();
  if (at_end_ == AtEnd::kAwait && child_ > 0) AwaitChild();
}

void HostProgram::AwaitChild() const {
  const Clock::time_point end = Clock::now() + kStopTime;
  while (waitpid(child_, nullptr, WNOHANG) == 0) {
    std::this_thread::sleep_for(kPoll);
    if (Clock::now() <= end) continue;
    kill(child_, SIGKILL);
    waitpid(child_, nullptr, 0);
    return Report([this] {
      return fmt::format("the ROS participant of this host (process {}) was killed, because it did not end in time",
                         child_);
    });
  }
}

Status HostProgram::Start() {
  Status error;
  const std::optional<int> connection = Open(error);
  if (!connection) return error;
  thread_ = std::thread([this, first = *connection] { Run(first); });
  return Status();
}

bool HostProgram::Wait(std::chrono::milliseconds time) const {
  pollfd waited = {wake_.descriptor(), POLLIN, 0};
  poll(&waited, 1, static_cast<int>(time.count()));
  return !stop_;
}

std::optional<int> HostProgram::Open(Status& error) {
  for (int occupied = 0;;) {
    const Result<int> connected = Connect(socket_);
    if (connected.ok()) return connected.value();
    if (child_ == 0) {
      std::error_code failure;
      const auto self = std::filesystem::read_symlink("/proc/self/exe", failure);
      std::vector<std::string> arguments = NetworkArguments(network_);
      arguments.insert(arguments.end(), {"--socket=" + socket_, "--while-used"});
      const Result<pid_t> started = StartProgram(self.parent_path() / kProgram, arguments);
      if (!started.ok()) {
        error = started.error();
        return std::nullopt;
      }
      child_ = started.value();
    }
    if (!Wait(kPoll)) return std::nullopt;
    int status = 0;
    if (waitpid(child_, &status, WNOHANG) <= 0) continue;
    const pid_t ended = std::exchange(child_, 0);
    if (status == 0) {  // another process was first
      if (++occupied < kMaxOccupied) continue;
      error =
          Failure("the socket '" + socket_ + "' of the ROS participant is in use, and no program of this user listens");
      return std::nullopt;
    }
    const bool is_refusal = WIFEXITED(status) && WEXITSTATUS(status) == kRefused;
    error = Error{{},
                  fmt::format("the ROS participant of this host (process {}) {}", ended, ToText(status)),
                  is_refusal ? ErrorCode::kBadInput : ErrorCode::kFailure};
    return std::nullopt;
  }
}

void HostProgram::Run(int connection) {
  std::chrono::milliseconds delay = kFirstStartDelay;
  std::optional<int> open = connection;
  while (open) {
    const Clock::time_point opened = Clock::now();
    pollfd waited[] = {{wake_.descriptor(), POLLIN, 0}, {*open, POLLIN, 0}};
    while (!stop_ && waited[1].revents == 0) poll(waited, 2, -1);
    close(*open);
    open.reset();
    if (stop_) return;
    // Here the program has ended, or has closed the connection.
    if (Clock::now() - opened > kHealthyProgram) delay = kFirstStartDelay;
    int status = 0;
    // Zero where another process has started the program: only its parent can wait for it.
    if (const pid_t ended = std::exchange(child_, 0); ended > 0) {
      if (waitpid(ended, &status, 0) == ended) {
        Report([&] {
          return fmt::format("the ROS participant of this host (process {}) {}; it is started again", ended,
                             ToText(status));
        });
      }
    }
    while (!open) {
      if (!Wait(delay)) return;
      delay = std::min(2 * delay, kMaxStartDelay);
      Status error;
      try {
        open = Open(error);
      } catch (const std::exception&) {  // as without memory: after the next delay
        continue;
      }
      if (!error.ok()) Report([&] { return error.error().message; });
    }
  }
}

Status StartForSession(std::uint32_t simulation_domain, const std::string& session, const std::string& own_enclave,
                       RosOptions& options, std::optional<HostProgram>& program,
                       std::function<void(const std::string&)> report) {
  RosNetwork network = options.network;
  if (network.security.enclave.empty()) network.security.enclave = own_enclave;
  options.socket = SocketOfSession(simulation_domain, session, network.security);
  program.emplace(options.socket, network, HostProgram::AtEnd::kLeave, std::move(report));
  return program->Start();
}

}  // namespace troupe::ros
