#include "tests/process/programs.h"

#include <gtest/gtest.h>
#include <poll.h>
#include <signal.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <sstream>

#include "command_line/parse_command_line.h"
#include "tests/support/dds_domain.h"
#include "tests/support/files.h"
#include "transport/dds/tools/control_client.h"

namespace troupe::test {
namespace {

using Clock = std::chrono::steady_clock;

constexpr auto kDeadline = std::chrono::seconds(90);
constexpr int kPollMilliseconds = 20;

std::string FromEnvironment(const char* name) {
  const char* value = std::getenv(name);
  EXPECT_NE(value, nullptr) << name << " is not set; run this test by ctest";
  return value != nullptr ? value : "";
}

// The programs of a run pass on what the programs that they start say, and restart some of those: a test that sees no
// more than the results would not notice their faults.
bool IsReportOfSanitizer(const std::string& line) {
  for (const char* start : {"ERROR: AddressSanitizer", "ERROR: LeakSanitizer", "WARNING: ThreadSanitizer"}) {
    if (line.find(start) != std::string::npos) return true;
  }
  return line.find(": runtime error: ") != std::string::npos;
}

Process StartOrFail(const std::vector<std::string>& command, const LinePipe& output) {
  Result<Process> process = Process::Start(command, output.writing_end());
  EXPECT_TRUE(process.ok()) << command.front();
  return std::move(process).value();
}

// True also for a process that has ended and that its parent has not waited for.
bool IsGone(pid_t process) {
  std::string stat = TextOf("/proc/" + std::to_string(process) + "/stat");
  std::size_t name_end = stat.rfind(") ");
  return name_end == std::string::npos || stat[name_end + 2] == 'Z' || stat[name_end + 2] == 'X';
}

}  // namespace

std::string ProgramPath(const std::string& name) {
  return FromEnvironment("TROUPE_BINARY_DIR") + "/bin/" + name;
}

std::string WorldPath(const std::string& name) {
  return FromEnvironment("TROUPE_SOURCE_DIR") + "/tests/process/worlds/" + name;
}

std::vector<pid_t> ChildrenOf(pid_t process) {
  std::vector<pid_t> children;
  std::error_code failure;
  for (const auto& thread :
       std::filesystem::directory_iterator("/proc/" + std::to_string(process) + "/task", failure)) {
    std::istringstream words(TextOf(thread.path() / "children"));
    for (pid_t child = 0; words >> child;) children.push_back(child);
  }
  return children;
}

std::vector<pid_t> DescendantsOf(pid_t process) {
  std::vector<pid_t> all;
  for (const pid_t child : ChildrenOf(process)) {
    all.push_back(child);
    for (const pid_t descendant : DescendantsOf(child)) all.push_back(descendant);
  }
  return all;
}

std::string CommandLineOf(pid_t process) {
  std::string line = TextOf("/proc/" + std::to_string(process) + "/cmdline");
  for (char& c : line) c = c == '\0' ? ' ' : c;
  return line;
}

bool IsGoneSoon(pid_t process) {
  return Eventually([process] { return IsGone(process); });
}

Program::Program(std::vector<std::string> command)
    : command_(testing::PrintToString(command)),
      pipe_(std::make_unique<LinePipe>()),
      process_(StartOrFail(command, *pipe_)) {
  pipe_->CloseWritingEnd();
}

// They end by themselves; the next run of the session must not find them.
Program::~Program() {
  if (!process_.running()) return;
  const std::vector<pid_t> descendants = DescendantsOf(pid());
  process_.Kill();
  for (const pid_t descendant : descendants) IsGoneSoon(descendant);
}

void Program::ReadMore() {
  pollfd waited{pipe_->reading_end(), POLLIN, 0};
  poll(&waited, 1, kPollMilliseconds);
  for (std::string& line : pipe_->Read()) {
    if (IsReportOfSanitizer(line)) ADD_FAILURE() << line;
    lines_.push_back(std::move(line));
  }
}

std::size_t Program::FindLine(const std::string& part, std::size_t following) {
  for (auto deadline = Clock::now() + kDeadline; Clock::now() < deadline; ReadMore()) {
    for (std::size_t i = 0; i + following < lines_.size(); ++i) {
      if (lines_[i].find(part) != std::string::npos) return i;
    }
    if (pipe_->at_end()) break;
  }
  ADD_FAILURE() << "no line with '" << part << "' in:\n" << output();
  return lines_.size();
}

std::string Program::WaitForLine(const std::string& part) {
  std::size_t line = FindLine(part, 0);
  return line < lines_.size() ? lines_[line] : "";
}

std::string Program::WaitForLineAfter(const std::string& part) {
  std::size_t line = FindLine(part, 1);
  return line + 1 < lines_.size() ? lines_[line + 1] : "";
}

bool Program::HasPrinted(const std::string& part) {
  ReadMore();
  return output().find(part) != std::string::npos;
}

int Program::Wait() {
  auto deadline = Clock::now() + kDeadline;
  while (!process_.Poll() && process_.running() && Clock::now() < deadline) {
    if (pipe_->at_end()) std::this_thread::sleep_for(std::chrono::milliseconds(kPollMilliseconds));
    ReadMore();
  }
  ReadMore();
  if (process_.running()) {
    ADD_FAILURE() << "did not end in time; its output:\n" << output();
    process_.Kill();
  }
  return process_.end()->exit_code;
}

void Program::Interrupt(const Caller& where) {
  Signal(SIGINT);
  const testing::ScopedTrace trace(where.file, where.line, "interrupted");
  EXPECT_EQ(Wait(), kExitInterrupted) << output();
}

std::string Program::output() {
  std::string text;
  for (const std::string& line : lines_) text += line + "\n";
  return text;
}

NetworkSettings NetworkOf(const std::string& session) {
  return {.domain = TestDomain(), .session = session};
}

Program Troupe(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), ProgramPath("troupe"));
  return Program(std::move(arguments));
}

Program RunPen(const std::vector<std::string>& arguments) {
  return Troupe(Words("run % --domain % --headless", {WorldPath("pen.world"), std::to_string(TestDomain())}) +
                arguments);
}

Finished Finish(Program program) {
  int exit_status = program.Wait();
  return {exit_status, program.output(), program.command()};
}

std::string OutputOf(const Finished& finished, int exit_status, const Caller& where) {
  const testing::ScopedTrace trace(where.file, where.line, finished.command);
  EXPECT_EQ(finished.exit_status, exit_status) << finished.output;
  return finished.output;
}

std::string OutputOf(Program program, int exit_status, const Caller& where) {
  return OutputOf(Finish(std::move(program)), exit_status, where);
}

ControlReply CallRun(const std::string& session, const control::Request& request) {
  ControlClient client(NetworkOf(session));
  EXPECT_TRUE(client.WaitForService(kSeconds).ok());
  const Result<ControlReply> reply = client.Call(request, kSeconds);
  EXPECT_TRUE(reply.ok());
  return reply.ok() ? reply.value() : ControlReply();
}

Finished Ctl(const std::string& session, const std::vector<std::string>& action) {
  return Finish(Troupe(Words("ctl --domain % --session %", {std::to_string(TestDomain()), session}) + action));
}

std::vector<pid_t> ChildrenWith(const Program& program, const std::string& part) {
  std::vector<pid_t> children = ChildrenOf(program.pid());
  std::erase_if(children, [&](pid_t child) { return CommandLineOf(child).find(part) == std::string::npos; });
  return children;
}

}  // namespace troupe::test
