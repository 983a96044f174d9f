#include "launcher/host_command.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "common/base/version.h"
#include "common/command_line/exit_status.h"
#include "launcher/far_messages.h"
#include "launcher/line_pipe.h"
#include "launcher/local_machine.h"
#include "launcher/signal_watch.h"

namespace troupe {
namespace {

constexpr std::size_t kPieceOfFile = 16384;  // bytes in a message

// A folder that is gone with this object.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::error_code failure;
    std::string pattern = (std::filesystem::temp_directory_path(failure) / "troupe-host-XXXXXX").string();
    if (!failure && mkdtemp(pattern.data()) != nullptr) path_ = pattern;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    if (!path_.empty()) std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

class Host {
 public:
  int Serve();

 private:
  void Say(const FarMessage& message) { launcher_is_there_ &= WriteAll(STDOUT_FILENO, ToLine(message)); }
  void Obey(const FarMessage& request);
  void Start(int id, const FarMessage& request);
  void SendFile(const std::string& path);
  void TellNews();

  SignalWatch signals_;
  TemporaryFolder folder_;
  LocalMachine machine_;
  std::map<int, std::unique_ptr<Child>> children_;
  bool launcher_is_there_ = true;
};

void Host::Start(int id, const FarMessage& request) {
  Result<std::unique_ptr<Child>> child = machine_.Start(
      request.at("program"), request.at("arguments").get<std::vector<std::string>>(), request.value("reports", false));
  if (!child.ok()) return Say({{"failed", id}, {"message", child.error().message}});
  Say({{"started", id}, {"pid", child.value()->pid()}});
  children_[id] = std::move(child).value();
}

void Host::SendFile(const std::string& path) {
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return Say({{"file", path}, {"error", strerror(errno)}});
  char data[kPieceOfFile];
  ssize_t size = 0;
  while (launcher_is_there_ && (size = read(file, data, sizeof data)) > 0) {
    Say({{"file", path}, {"data", ToHexadecimal(data, static_cast<std::size_t>(size))}});
  }
  if (size < 0) {
    Say({{"file", path}, {"error", strerror(errno)}});
  } else {
    Say({{"file", path}, {"end", true}});
  }
  close(file);
}

void Host::Obey(const FarMessage& request) {
  try {
    if (request.contains("start")) {
      Start(request["start"], request);
    } else if (request.contains("signal")) {
      const auto child = children_.find(request["signal"]);
      if (child != children_.end()) child->second->Signal(request.at("number"));
    } else if (request.contains("read")) {
      SendFile(request["read"]);
    }
  } catch (const FarMessage::exception& fault) {
    Say({{"output", std::string("error: a bad request: ") + fault.what()}});
  }
}

void Host::TellNews() {
  // Whether a process has ended is asked before its last words are read, so that none come after its end.
  std::vector<int> ended;
  for (const auto& [id, child] : children_) {
    if (child->Poll()) ended.push_back(id);
  }
  for (const std::string& line : machine_.TakeOutput()) Say({{"output", line}});
  for (const std::string& line : machine_.TakeReports()) Say({{"report", line}});
  for (int id : ended) {
    const ProcessEnd& end = *children_[id]->end();
    Say({{"ended", id},
         {"exit_code", end.exit_code},
         {"signal", end.signal},
         {"peak_memory_mib", end.peak_memory_mib}});
    children_.erase(id);
  }
}

int Host::Serve() {
  if (folder_.path().empty()) {
    std::fprintf(stderr, "error: cannot make a folder for temporary files\n");
    return kExitFailed;
  }
  for (const char* program : {"world-service", "robot-agent"}) {
    Result<std::string> path = FindProgram(program);
    if (path.ok()) continue;
    std::fprintf(stderr, "%s\n", path.error().ToString().c_str());
    return kExitFailed;
  }
  Say({{"host", VersionText()},
       {"folder", folder_.path()},
       {"programs", std::filesystem::path(machine_.ProgramPath("troupe")).parent_path().string()}});
  LineReader requests(STDIN_FILENO);
  while (launcher_is_there_ && !requests.at_end()) {
    std::vector<pollfd> waited = {{signals_.descriptor(), POLLIN, 0}, {STDIN_FILENO, POLLIN, 0}};
    for (int descriptor : machine_.descriptors()) waited.push_back({descriptor, POLLIN, 0});
    poll(waited.data(), waited.size(), -1);
    if (signals_.TakeStopRequest()) break;
    for (const std::string& line : requests.Read()) Obey(ParseFarMessage(line));
    TellNews();
  }
  for (auto& [id, child] : children_) child->Kill();
  return kExitDone;
}

}  // namespace

int HostCommand() {
  signal(SIGPIPE, SIG_IGN);
  return Host().Serve();
}

}  // namespace troupe
