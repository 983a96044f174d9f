#include "launcher/far_machine.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <string.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <utility>

#include "common/base/version.h"
#include "launcher/far_messages.h"
#include "launcher/shell_words.h"

namespace troupe {
namespace {

using Clock = std::chrono::steady_clock;

// BatchMode: nobody is there to type a password. The rest notices a dead network.
constexpr const char* kDefaultStart =
    "ssh -T -o BatchMode=yes -o ConnectTimeout=10 -o ServerAliveInterval=5 -o ServerAliveCountMax=3 {address} "
    "{command_text}";

constexpr auto kTimeForHost = std::chrono::seconds(3);      // of a host without processes
constexpr auto kLongestSilence = std::chrono::seconds(30);  // while a file is sent

std::string ConnectingCommand(const HostSettings& host) {
  std::string programs = host.programs;
  if (programs.empty()) {
    Result<std::string> here = FindProgram("troupe");
    if (here.ok()) programs = std::filesystem::path(here.value()).parent_path().string();
  }
  const std::string command = Quoted(std::vector<std::string>{programs + "/troupe", "host"});
  return FillIn(host.start.empty() ? kDefaultStart : host.start, {{"command", command},
                                                                  {"command_text", Quoted(command)},
                                                                  {"address", Quoted(host.address)},
                                                                  {"name", Quoted(host.name)}});
}

void WaitFor(const std::vector<int>& descriptors, std::chrono::milliseconds timeout) {
  std::vector<pollfd> waited;
  for (int descriptor : descriptors) waited.push_back({descriptor, POLLIN, 0});
  poll(waited.data(), waited.size(), static_cast<int>(timeout.count()));
}

}  // namespace

class FarMachine::FarChild : public Child {
 public:
  FarChild(FarMachine& machine, int id, std::shared_ptr<State> state)
      : machine_(machine), id_(id), state_(std::move(state)) {}
  pid_t pid() const override { return state_->pid; }
  const std::optional<ProcessEnd>& end() const override { return state_->end; }
  bool Poll() override { return state_->end && !std::exchange(state_->told, true); }
  void Signal(int signal) override {
    if (!state_->end) machine_.Send(ToLine({{"signal", id_}, {"number", signal}}));
  }
  void Kill() override {
    Signal(SIGKILL);
    // It may be beyond reach; its host ends it when the connection ends.
    if (!state_->end) state_->end = ProcessEnd{128 + SIGKILL, SIGKILL, 0.0};
  }

 private:
  FarMachine& machine_;
  const int id_;
  const std::shared_ptr<State> state_;
};

FarMachine::FarMachine(const HostSettings& settings, std::string command)
    : settings_(settings), command_(std::move(command)) {}

Result<std::unique_ptr<FarMachine>> FarMachine::Connect(const HostSettings& settings) {
  std::unique_ptr<FarMachine> machine(new FarMachine(settings, ConnectingCommand(settings)));
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) return Error{{}, std::string("cannot make a pipe: ") + strerror(errno)};
  machine->requests_ = ends[1];
  Result<Process> connection =
      Process::Start({"/bin/sh", "-c", machine->command_},
                     {ends[0], machine->messages_.writing_end(), machine->errors_.writing_end()});
  close(ends[0]);
  machine->messages_.CloseWritingEnd();
  machine->errors_.CloseWritingEnd();
  if (!connection.ok()) return connection.error();
  machine->connection_ = std::move(connection).value();
  return machine;
}

FarMachine::~FarMachine() {
  if (requests_ >= 0) close(requests_);
  const auto deadline = Clock::now() + kTimeForHost;
  while (connection_ && connection_->running() && !connection_->Poll() && Clock::now() < deadline) {
    WaitFor({messages_.at_end() ? -1 : messages_.reading_end()}, std::chrono::milliseconds(10));
    messages_.Read();
  }
}

void FarMachine::Send(const std::string& line) {
  if (requests_ < 0 || WriteAll(requests_, line)) return;
  close(std::exchange(requests_, -1));
}

Result<std::unique_ptr<Child>> FarMachine::Start(const std::string& program, const std::vector<std::string>& arguments,
                                                 bool reports) {
  const int id = static_cast<int>(children_.size());
  auto state = std::make_shared<State>();
  children_[id] = state;
  std::vector<std::string> words = arguments;
  Send(ToLine({{"start", id}, {"program", program}, {"arguments", words}, {"reports", reports}}));
  return std::unique_ptr<Child>(std::make_unique<FarChild>(*this, id, std::move(state)));
}

std::vector<int> FarMachine::descriptors() const {
  std::vector<int> open;
  if (!messages_.at_end()) open.push_back(messages_.reading_end());
  if (!errors_.at_end()) open.push_back(errors_.reading_end());
  return open;
}

void FarMachine::Read() {
  // What the connection says of itself; the machine's processes speak in messages.
  for (std::string& line : errors_.Read()) {
    last_words_ = line;
    output_.push_back(std::move(line));
  }
  for (const std::string& line : messages_.Read()) HandleLine(line);
  if (messages_.at_end() && !lost_) {
    const auto deadline = Clock::now() + std::chrono::seconds(1);  // its end follows at once
    while (!connection_->Poll() && connection_->running() && Clock::now() < deadline) {
      WaitFor({}, std::chrono::milliseconds(5));
    }
    for (std::string& line : errors_.Read()) {
      last_words_ = line;
      output_.push_back(std::move(line));
    }
    Lose(connection_->end() ? connection_->end()->ToString() : "closed its output");
  }
}

void FarMachine::HandleLine(const std::string& line) try {
  const FarMessage message = ParseFarMessage(line);
  if (!message.is_object()) {
    output_.push_back(line);  // of a login script, perhaps
  } else if (message.contains("host")) {
    if (message["host"] != VersionText()) {
      return Lose("has version " + message["host"].get<std::string>() + " of Troupe, expected " +
                  std::string(VersionText()));
    }
    folder_ = message.at("folder");
    programs_ = message.at("programs");
    ready_ = true;
  } else if (message.contains("output")) {
    output_.push_back(message["output"]);
  } else if (message.contains("report")) {
    reports_.push_back(message["report"]);
  } else if (message.contains("started")) {
    children_.at(message["started"])->pid = message.at("pid");
  } else if (message.contains("failed")) {
    output_.push_back("error: " + message.at("message").get<std::string>());
    children_.at(message["failed"])->end = ProcessEnd{127, 0, 0.0};
  } else if (message.contains("ended")) {
    State& state = *children_.at(message["ended"]);
    if (!state.end)
      state.end = ProcessEnd{message.at("exit_code"), message.at("signal"), message.at("peak_memory_mib")};
  } else if (message.contains("file") && message["file"] == file_) {
    if (message.contains("data") && !WriteAll(file_target_, FromHexadecimal(message["data"]))) {
      file_error_ = strerror(errno);
    }
    if (message.contains("error")) file_error_ = message["error"];
    if (message.contains("error") || message.contains("end")) file_complete_ = true;
  }
} catch (const std::exception&) {
  output_.push_back(line);
}

void FarMachine::Lose(const std::string& why) {
  if (std::exchange(lost_, true)) return;
  std::string text =
      "host " + settings_.name + ": " + (ready_ ? "the connection is lost: " : "") + "`" + command_ + "` " + why;
  if (!ready_)
    text += "; expected the programs of Troupe " + std::string(VersionText()) + " there, and a way to start them";
  if (!ready_ && !last_words_.empty()) text += "; it said: " + last_words_;
  loss_ = Error{ready_ ? SourceLocation{} : settings_.where, text};
  for (auto& [id, state] : children_) {
    if (!state->end) state->end = ProcessEnd{255, 0, 0.0};
  }
}

std::vector<std::string> FarMachine::TakeOutput() {
  Read();
  return std::exchange(output_, {});
}

std::vector<std::string> FarMachine::TakeReports() {
  Read();
  return std::exchange(reports_, {});
}

Status FarMachine::TakeLoss() {
  return std::exchange(loss_, std::nullopt);
}

Status FarMachine::Fetch(const std::string& from, const std::string& to) {
  const std::string what = "host " + name() + ": cannot fetch " + from + " to " + to + ": ";
  file_target_ = open(to.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (file_target_ < 0) return Error{{}, what + strerror(errno)};
  file_ = from;
  file_error_.clear();
  file_complete_.reset();
  Send(ToLine({{"read", from}}));
  while (!file_complete_ && file_error_.empty()) {
    const auto began = Clock::now();
    WaitFor(descriptors(), kLongestSilence);
    if (Clock::now() - began >= kLongestSilence) file_error_ = "nothing more came";
    Read();
    if (lost_) file_error_ = "the connection is lost";
  }
  file_.clear();
  if (close(std::exchange(file_target_, -1)) != 0 && file_error_.empty()) file_error_ = strerror(errno);
  if (!file_error_.empty()) return Error{{}, what + file_error_};
  return std::nullopt;
}

Result<std::vector<std::unique_ptr<FarMachine>>> ConnectAll(const std::vector<HostSettings>& hosts,
                                                            std::chrono::seconds timeout, SignalWatch& signals,
                                                            bool* interrupted) {
  std::vector<std::unique_ptr<FarMachine>> machines;
  for (const HostSettings& host : hosts) {
    Result<std::unique_ptr<FarMachine>> machine = FarMachine::Connect(host);
    if (!machine.ok()) return machine.error();
    machines.push_back(std::move(machine).value());
  }
  const auto deadline = Clock::now() + timeout;
  while (true) {
    std::vector<int> waited = {signals.descriptor()};
    std::string awaited;
    for (const std::unique_ptr<FarMachine>& machine : machines) {
      machine->TakeOutput();  // of logins; what matters is in the error
      if (Status loss = machine->TakeLoss()) return *loss;
      if (machine->ready()) continue;
      awaited += (awaited.empty() ? "" : ", ") + machine->name();
      for (int descriptor : machine->descriptors()) waited.push_back(descriptor);
    }
    if (awaited.empty()) return machines;
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now());
    if (left.count() <= 0) {
      return Error{{},
                   "no word from host " + awaited + " within " + std::to_string(timeout.count()) +
                       " s; expected its `start` command to start programs there"};
    }
    WaitFor(waited, left);
    if (signals.TakeStopRequest()) {
      *interrupted = true;
      return Error{{}, "stopped while waiting for host " + awaited};
    }
  }
}

}  // namespace troupe
