#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <poll.h>
#include <signal.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "command_line/parse_command_line.h"
#include "common/base/file.h"
#include "common/base/identity.h"
#include "common/base/json.h"
#include "common/base/print.h"
#include "common/base/text.h"
#include "launcher/commands/commands.h"
#include "launcher/hosts/connect_hosts.h"
#include "launcher/hosts/host.h"
#include "launcher/process/process.h"
#include "transport/protocol/message_texts.h"
#include "transport/security/key_authority.h"
#include "transport/security/session_keys.h"

namespace troupe {
namespace {

constexpr std::size_t kPieceOfFile = 16384;  // bytes in a message

// `troupe host`: the counterpart of RemoteHost (launcher/hosts/remote_host.h). Requests are JSON lines on standard
// input, replies and news are JSON lines on standard output; the connection is ssh or any other program that passes
// both on. The end of standard input kills all processes and deletes the folder: a host keeps nothing of a run that has
// lost its launcher.
class HostServer {
 public:
  int Serve();

 private:
  void Send(const HostMessage& message) { connected_ &= WriteAll(STDOUT_FILENO, ToLine(message)); }
  void Execute(const JsonReader& request);
  void Start(int id, const JsonReader& request);
  void KeepKey(const std::string& name, const std::string& content);
  void SendFile(const std::string& path);
  void SendNews();

  SignalWatch signals_;
  HostFolder folder_;
  LocalHost host_;
  std::map<int, std::unique_ptr<Child>> children_;
  bool connected_ = true;
};

// `id`: the launcher's number of the process, in all further messages about it.
void HostServer::Start(int id, const JsonReader& request) {
  const auto program = request.Get<std::string>("program");
  const auto arguments = request.Get<std::vector<std::string>>("arguments");
  const bool reports = request.Optional<bool>("reports").value_or(false);
  if (!request.ok()) return;
  Result<std::unique_ptr<Child>> child = host_.Start(program, arguments, reports);
  if (!child.ok()) return Send({{"failed", id}, {"message", child.error().message}});
  Send({{"started", id}, {"pid", child.value()->pid()}});
  children_[id] = std::move(child).value();
}

// In pieces, so that a large file neither fills the memory nor delays other messages for long. Hexadecimal: a line of
// JSON cannot carry any byte.
void HostServer::SendFile(const std::string& path) {
  const Result<FileDescriptor> file = OpenToRead(path);
  if (!file.ok()) return Send({{"file", path}, {"error", file.error().message}});
  char data[kPieceOfFile];
  ssize_t size = 0;
  while (connected_ && (size = read(file.value().get(), data, sizeof data)) > 0) {
    Send({{"file", path}, {"data", ToHexadecimal(std::as_bytes(std::span(data, static_cast<std::size_t>(size))))}});
  }
  if (size < 0) {
    Send({{"file", path}, {"error", strerror(errno)}});
  } else {
    Send({{"file", path}, {"end", true}});
  }
}

void HostServer::KeepKey(const std::string& name, const std::string& content) {
  const std::filesystem::path path = std::filesystem::path(folder_.path()) / kKeysFolderOfHost / name;
  std::error_code failure;
  std::filesystem::create_directories(path.parent_path(), failure);  // in a folder of mode 0700
  FileDescriptor file(open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600));
  if (file.get() >= 0 && WriteAll(file.get(), content) && file.Close()) return;
  Send({{"output", "error: cannot write " + path.string() + ": " + strerror(errno)}});
}

// Launcher and host are of one version (RemoteHost compares them), so that each request is one of these.
void HostServer::Execute(const JsonReader& request) {
  if (request.Has("run")) {
    const auto run = request.Get<std::string>("run");
    if (request.ok()) folder_.TakeOver(run);
  } else if (request.Has("start")) {
    Start(request.Get<int>("start"), request);
  } else if (request.Has("signal")) {
    const auto child = children_.find(request.Get<int>("signal"));
    const int number = request.Get<int>("number");
    if (request.ok() && child != children_.end()) child->second->Signal(number);
  } else if (request.Has("tell")) {
    const auto child = children_.find(request.Get<int>("tell"));
    const auto line = request.Get<std::string>("line");
    if (request.ok() && child != children_.end()) child->second->Tell(line);
  } else if (request.Has("ping")) {
    Send({{"pong", true}});
  } else if (request.Has("key")) {
    const auto name = request.Get<std::string>("key");
    const std::string content = BytesIn(request, "data");
    if (request.ok()) KeepKey(name, content);
  } else if (request.Has("read")) {
    const auto path = request.Get<std::string>("read");
    if (request.ok()) SendFile(path);
  }
  if (!request.ok()) Send({{"output", "error: a bad request: " + request.status().error().message}});
}

void HostServer::SendNews() {
  // Ends of processes are polled before the last lines are read, so that no line follows the end of its process.
  std::vector<int> ended;
  for (const auto& [id, child] : children_) {
    if (child->Poll()) ended.push_back(id);
  }
  for (const std::string& line : host_.ReadOutput()) Send({{"output", line}});
  for (const std::string& line : host_.ReadReports()) Send({{"report", line}});
  for (int id : ended) {
    const ProcessEnd& end = *children_[id]->end();
    Send({{"ended", id},
          {"exit_code", end.exit_code},
          {"signal", end.signal},
          {"peak_memory_mib", end.peak_memory_mib}});
    children_.erase(id);
  }
}

// The first line names version, folder and programs: the launcher refuses another version before it starts anything.
int HostServer::Serve() {
  if (folder_.path().empty()) return Fail(Failure("cannot make a folder for temporary files"));
  for (const char* program : {"world-service", "robot-agent"}) {
    if (const Result<std::string> path = FindProgram(program); !path.ok()) return Fail(path.error());
  }
  Send({{"host", VersionText()},
        {"folder", folder_.path()},
        {"programs", std::filesystem::path(host_.ProgramPath("troupe")).parent_path().string()}});
  LineReader requests(STDIN_FILENO);
  while (connected_ && !requests.at_end()) {
    std::vector<pollfd> waited = {{signals_.descriptor(), POLLIN, 0}, {STDIN_FILENO, POLLIN, 0}};
    for (int descriptor : host_.descriptors()) waited.push_back({descriptor, POLLIN, 0});
    poll(waited.data(), waited.size(), -1);
    if (signals_.ReadStopRequest()) break;
    for (const std::string& line : requests.Read()) Execute(ReadHostMessage(line));
    SendNews();
  }
  for (auto& [id, child] : children_) child->Kill();
  return kExitDone;
}

namespace fs = std::filesystem;

struct KeysOptions {
  std::string folder;
  std::vector<std::string> robots;               // each alone in its agent
  std::vector<std::vector<std::string>> agents;  // the robots of each
};

// The owner of an identity of DDS Security (docs/security.md).
struct Holder {
  std::string name;  // for users
  Role role;
};

std::vector<Holder> HoldersOf(const KeysOptions& options) {
  std::vector<Holder> holders = {
      {"service", Role::Service()}, {"operator", Role::Operator()}, {"observer", Role::Observer()}};
  std::vector<std::vector<std::string>> agents = options.agents;
  for (const std::string& robot : options.robots) agents.push_back({robot});
  for (const std::vector<std::string>& robots : agents) {
    holders.push_back({fmt::format("agent of {}", fmt::join(robots, ", ")), Role::Agent(AgentName(robots))});
  }
  return holders;
}

void Print(const std::string& name, const fs::path& path, bool made) {
  PrintPlain(stdout, "{}: {}{}\n", name, path.string(), made ? "" : " (kept)");
}

// The authority of the folder, which is made if the folder is new or empty.
Result<KeyAuthority> AuthorityOf(const fs::path& folder) {
  const fs::path path = folder / "authority";
  std::error_code failure;
  if (fs::exists(path, failure)) {
    Result<KeyAuthority> loaded = KeyAuthority::Load(path.string());
    if (loaded.ok()) Print("authority", path, false);
    return loaded;
  }
  if (fs::exists(folder, failure) && !(fs::is_directory(folder, failure) && fs::is_empty(folder, failure))) {
    return Error{{folder.string()}, "found no authority in it, expected a new folder or one of 'troupe keys make'"};
  }
  Result<KeyAuthority> made = KeyAuthority::Create();
  if (!made.ok()) return made;
  if (Status saved = made.value().Save(path.string()); !saved.ok()) return saved.error();
  Print("authority", path, true);
  return made;
}

// Existing identities are kept, so that a robot can be added to a folder that is in use.
int MakeKeys(const KeysOptions& options) {
  const fs::path folder(options.folder);
  const Result<KeyAuthority> authority = AuthorityOf(folder);
  if (!authority.ok()) return Fail(authority.error());
  for (const Holder& holder : HoldersOf(options)) {
    const fs::path path = folder / KeyFolder(holder.role);
    std::error_code failure;
    const bool kept = fs::exists(path, failure);
    if (!kept) {
      const Status written = authority.value().WriteIdentity(path.string(), holder.role);
      if (!written.ok()) return Fail(written.error());
    }
    Print(holder.name, path, !kept);
  }
  return kExitDone;
}

}  // namespace

void AddHostCommand(CLI::App& app, int& exit_status) {
  CLI::App* const command =
      app.add_subcommand("host", "Start processes for a launcher on another host; started by that launcher");
  const auto task = std::make_shared<std::string>();
  const auto probe = std::make_shared<MulticastProbe>();
  command->add_option("--multicast", *task, "Instead: send or listen, for a launcher that tries the network")
      ->check(OneOf({"send", "listen"}))
      ->type_name("TASK");
  command->add_option("--interface", probe->network_interface, "Of these: network interface")->type_name("NAME");
  command->add_option("--port", probe->port, "Of these: UDP port")->type_name("PORT");
  command->add_option("--word", probe->word, "Of these: content of the datagrams")->type_name("TEXT");
  command->final_callback([&exit_status, task, probe] {
    if (!task->empty()) {
      exit_status = *task == "send" ? SendMulticast(*probe) : ListenForMulticast(*probe);
      return;
    }
    signal(SIGPIPE, SIG_IGN);
    exit_status = HostServer().Serve();
    DeleteNamesOfDeletedKeys();  // of services that were killed, whose folders are gone now
  });
}

void AddKeysCommand(CLI::App& app, int& exit_status) {
  CLI::App* keys = app.add_subcommand("keys", "Make the keys of secured runs");
  keys->require_subcommand(1);
  CLI::App* make = keys->add_subcommand(
      "make", "Make keys for a service, an operator, an observer and agents; in a folder with keys, the missing ones");
  auto options = std::make_shared<KeysOptions>();
  make->add_option("DIR", options->folder, "Folder of the keys; a program that can read it can join the runs")
      ->required()
      ->check(NotEmpty())
      ->type_name("");
  make->add_option("--robots", options->robots, "Robots that each have an agent process of their own")
      ->delimiter(',')
      ->allow_extra_args(false)  // which would be DIR
      ->check(NotEmpty())
      ->type_name("NAME[,NAME]");
  make->add_option_function<std::vector<std::string>>(
          "--agent",
          [options](const std::vector<std::string>& values) {
            for (const std::string& robots : values) options->agents.push_back(CLI::detail::split(robots, ','));
          },
          "Robots of one agent process, in their order; repeatable")
      ->allow_extra_args(false)
      ->check(NotEmpty())
      ->type_name("NAME[,NAME]");
  make->final_callback([options, &exit_status] { exit_status = MakeKeys(*options); });
}

}  // namespace troupe
