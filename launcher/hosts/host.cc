#include "launcher/hosts/host.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string_view>
#include <system_error>
#include <thread>
#include <utility>

#include "command_line/parse_command_line.h"
#include "common/base/file.h"
#include "common/base/json.h"
#include "common/base/locked_folder.h"
#include "common/base/system_error.h"
#include "common/base/text.h"

namespace troupe {
namespace {

// A child of this process.
class LocalChild : public Child {
 public:
  // `input`: the writing end of a pipe to its standard input, which does not block.
  LocalChild(Process process, FileDescriptor input) : process_(std::move(process)), input_(std::move(input)) {}
  pid_t pid() const override { return process_.pid(); }
  const std::optional<ProcessEnd>& end() const override { return process_.end(); }
  bool Poll() override {
    WriteUntold();
    return process_.Poll();
  }
  void Tell(const std::string& line) override {
    if (input_.get() < 0 || !running()) return;
    untold_ += line + "\n";
    WriteUntold();
  }
  void Signal(int signal) override { process_.Signal(signal); }
  void Kill() override { process_.Kill(); }

 private:
  // As much as the pipe takes: a process that was stopped reads nothing, and must not stop this one.
  void WriteUntold() {
    while (!untold_.empty()) {
      const ssize_t written = write(input_.get(), untold_.data(), untold_.size());
      if (written < 0 && errno == EINTR) continue;
      if (written < 0 && errno != EAGAIN) untold_.clear();
      if (written < 0) return;
      untold_.erase(0, static_cast<std::size_t>(written));
    }
  }

  Process process_;
  FileDescriptor input_;
  std::string untold_;
};

// Bytes of the arguments of a program. The system takes 2 MB in most places.
constexpr std::size_t kMaxArguments = 200'000;

std::size_t SizeOf(const std::vector<std::string>& command) {
  std::size_t size = 0;
  for (const std::string& word : command) size += word.size() + 1 + sizeof(char*);
  return size;
}

// A file in memory with arguments, for kArgumentsOption.
// An agent of a thousand robots has a command line beyond the limits of some systems.
Result<FileDescriptor> ArgumentsFile(const std::vector<std::string>& arguments) {
  std::string text;
  for (const std::string& argument : arguments) text.append(argument).push_back('\0');
  FileDescriptor file(memfd_create("arguments", MFD_CLOEXEC));
  if (file.get() < 0 || !WriteAll(file.get(), text) || lseek(file.get(), 0, SEEK_SET) != 0) {
    return SystemError("cannot pass the arguments of a program");
  }
  return file;
}

namespace fs = std::filesystem;

constexpr std::string_view kPrefix = "troupe-host-";
constexpr std::string_view kRandom = "XXXXXX";
constexpr const char* kNameFile = "name";  // of what the host serves
constexpr auto kEndPeriod = std::chrono::milliseconds(10);
constexpr int kEndPeriods = 200;  // until a host that is killed has ended

// Folders of other names may belong to a process that does not lock them.
bool IsName(std::string_view name) {
  if (!name.starts_with(kPrefix)) return false;
  name.remove_prefix(kPrefix.size());
  const std::size_t digits = std::min(name.find_first_not_of("0123456789"), name.size());
  return digits > 0 && name.size() == digits + 1 + kRandom.size() && name[digits] == '-';
}

// Of the process with this folder. REQUIRES: IsName
pid_t ProcessOf(const fs::path& path) {
  return static_cast<pid_t>(std::atol(path.filename().c_str() + kPrefix.size()));
}

void EndHostThatServes(const std::string& name, const fs::path& path) {
  std::string served;
  std::ifstream file(path / kNameFile);
  if (!std::getline(file, served) || served != name) return;
  // The lock shows that the process lives, and has not given its number to another one.
  const pid_t process = ProcessOf(path);
  if (LockedFolder::IsHeld(path) && process > 1 && process != getpid() && kill(process, SIGKILL) == 0) {
    for (int i = 0; i < kEndPeriods && LockedFolder::IsHeld(path); ++i) std::this_thread::sleep_for(kEndPeriod);
  }
  LockedFolder::DeleteIfAbandoned(path);
}

void DeleteFoldersOfKilledHosts(const fs::path& parent) {
  std::error_code failure;
  for (const fs::directory_entry& entry : fs::directory_iterator(parent, failure)) {
    if (IsName(entry.path().filename().string())) LockedFolder::DeleteIfAbandoned(entry.path());
  }
}

}  // namespace

std::string LocalHost::ProgramPath(const std::string& program) const {
  Result<std::string> path = FindProgram(program);
  return path.ok() ? path.value() : program;
}

// Output of all children goes into one pipe, and reports into another: lines are complete, and their order is that of
// writing.
Result<std::unique_ptr<Child>> LocalHost::Start(const std::string& program, const std::vector<std::string>& arguments,
                                                bool reports) {
  Result<std::string> path = FindProgram(program);
  if (!path.ok()) return path.error();
  std::vector<std::string> command = {path.value()};
  command.insert(command.end(), arguments.begin(), arguments.end());
  FileDescriptor arguments_file(-1);
  if (!reports && SizeOf(command) > kMaxArguments) {
    Result<FileDescriptor> file = ArgumentsFile(arguments);
    if (!file.ok()) return file.error();
    arguments_file = std::move(file).value();
    command = {path.value(), kArgumentsOption + std::to_string(arguments_file.get())};
  }
  if (reports) command.push_back("--report-fd=" + std::to_string(reports_.writing_end()));
  FileDescriptor input(-1);
  FileDescriptor told(-1);  // its other end
  if (reports) {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) return SystemError("cannot make a pipe");
    input = FileDescriptor(ends[0]);
    told = FileDescriptor(ends[1]);
    fcntl(ends[1], F_SETFL, O_NONBLOCK);
  }
  const Addresses addresses = program == "robot-agent" ? agent_addresses_ : Addresses::kRandom;
  Result<Process> process = Process::Start(command, {input.get(), output_.writing_end(), output_.writing_end()},
                                           reports ? reports_.writing_end() : arguments_file.get(), addresses);
  if (!process.ok()) return process.error();
  return std::unique_ptr<Child>(std::make_unique<LocalChild>(std::move(process).value(), std::move(told)));
}

std::vector<int> LocalHost::descriptors() const {
  return {output_.reading_end(), reports_.reading_end()};
}

Status LocalHost::Fetch(const std::string& from, const std::string&, const FetchProgress&) {
  return Failure(from + " is on this host already");
}

std::string ToLine(const HostMessage& message) {
  return JsonText(message) + "\n";
}

// The other end is of the same program, but a login script may print into the connection.
JsonReader ReadHostMessage(const std::string& line) {
  JsonReader message = JsonReader::OfText(line, "", JsonLimits::OfProcesses());
  if (!message.node().is_object()) message.Fail("an object");
  return message;
}

std::string BytesIn(const JsonReader& message, const char* key) {
  const std::optional<std::string> bytes = FromHexadecimal(message.Get<std::string>(key));
  if (!bytes) message.FailWithout(key, "pairs of hexadecimal digits");
  return bytes.value_or("");
}

// Inside single quotes a shell changes nothing; a quote itself ends them, is escaped, and begins them again.
std::string ShellQuoted(const std::string& word) {
  auto plain = [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
           std::string_view("/.,:=_+-").find(c) != std::string_view::npos;
  };
  if (!word.empty() && std::all_of(word.begin(), word.end(), plain)) return word;
  std::string quoted = "'";
  for (char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

std::string ShellQuoted(const std::vector<std::string>& words) {
  std::string line;
  for (const std::string& word : words) line += (line.empty() ? "" : " ") + ShellQuoted(word);
  return line;
}

std::string FillIn(const std::string& text, const std::map<std::string, std::string>& values) {
  std::string filled;
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t end = text[i] == '{' ? text.find('}', i) : std::string::npos;
    const auto value = end == std::string::npos ? values.end() : values.find(text.substr(i + 1, end - i - 1));
    if (value == values.end()) {
      filled += text[i++];
    } else {
      filled += value->second;
      i = end + 1;
    }
  }
  return filled;
}

HostFolder::HostFolder() {
  std::error_code failure;
  const fs::path parent = fs::temp_directory_path(failure);
  if (failure) return;
  DeleteFoldersOfKilledHosts(parent);
  folder_ = LockedFolder::Make((parent / kPrefix).string() + std::to_string(getpid()) + "-" + std::string(kRandom));
}

// The others are listed before the first ends, as their folders disappear with them.
void HostFolder::TakeOver(const std::string& name) {
  if (path().empty()) return;
  std::error_code failure;
  std::vector<fs::path> others;
  for (const fs::directory_entry& entry : fs::directory_iterator(fs::path(path()).parent_path(), failure)) {
    if (IsName(entry.path().filename().string()) && entry.path() != path()) others.push_back(entry.path());
  }
  for (const fs::path& other : others) EndHostThatServes(name, other);
  std::ofstream(fs::path(path()) / kNameFile) << name << "\n";
}

}  // namespace troupe
