// The real programs as children of a test, with deadlines; none of them outlives its test.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "common/run/run_settings.h"
#include "launcher/process/process.h"
#include "tests/support/words.h"
#include "transport/protocol/messages.h"

namespace troupe::test {

// The place of a call, for messages: a default argument. clang 14 lacks std::source_location.
struct Caller {
  const char* file;
  int line;
  static Caller Here(const char* file = __builtin_FILE(), int line = __builtin_LINE()) { return {file, line}; }
};

inline constexpr double kSeconds = 60.0;                  // longest time to an answer on the slowest machine
inline constexpr std::int64_t kIntervalNs = 100'000'000;  // of pen.world

// Sanitizers reserve more addresses than any limit leaves.
#ifdef TROUPE_SANITIZED
inline constexpr bool kCanLimitMemory = false;
#else
inline constexpr bool kCanLimitMemory = true;
#endif

// The path of a program of this build.
std::string ProgramPath(const std::string& name);
// The path of a world beside these tests.
std::string WorldPath(const std::string& name);

// The running children of the process.
std::vector<pid_t> ChildrenOf(pid_t process);
// With their children, and so on.
std::vector<pid_t> DescendantsOf(pid_t process);
// The arguments that a process was started with, joined by spaces.
std::string CommandLineOf(pid_t process);
// True if the process ends within a time that is long for the slowest computer.
bool IsGoneSoon(pid_t process);

class Program {
 public:
  explicit Program(std::vector<std::string> command);
  Program(Program&&) = default;
  Program& operator=(Program&&) = default;
  ~Program();  // kills it if it still runs, and waits for the ends of the processes that it has started

  pid_t pid() const { return process_.pid(); }
  void Signal(int signal) const { process_.Signal(signal); }
  // Waits for the first printed line that contains `part`; without one within the deadline the test fails, and the
  // result is "".
  std::string WaitForLine(const std::string& part);
  // The line after it.
  std::string WaitForLineAfter(const std::string& part);
  // Whether a line that it has printed so far contains `part`.
  bool HasPrinted(const std::string& part);
  bool HasEnded() { return process_.Poll() || !process_.running(); }
  // Waits for the end, and returns the exit status; without an end within the deadline the test fails.
  int Wait();
  // Stops a run in order, as Ctrl-C does, and expects its exit status.
  void Interrupt(const Caller& where = Caller::Here());
  // All output so far.
  std::string output();
  const std::string& command() const { return command_; }

 private:
  std::size_t FindLine(const std::string& part, std::size_t following);
  void ReadMore();

  std::string command_;
  std::unique_ptr<LinePipe> pipe_;  // on the heap, so that programs can be moved
  Process process_;
  std::vector<std::string> lines_;
};

// For tools of this test that follow or control a run which RunPen or Troupe has started in TestDomain().
NetworkSettings NetworkOf(const std::string& session);

// `troupe` with these arguments.
Program Troupe(std::vector<std::string> arguments);
// `troupe run` of pen.world in a domain of this test, with additional arguments.
Program RunPen(const std::vector<std::string>& arguments);

struct Finished {
  int exit_status = 0;
  std::string output;
  std::string command;
};
Finished Finish(Program program);
// The output of a program that has to end with this exit status.
std::string OutputOf(const Finished& finished, int exit_status = 0, const Caller& where = Caller::Here());
std::string OutputOf(Program program, int exit_status = 0, const Caller& where = Caller::Here());
// The reply of a run of TestDomain(), by a client of its own: the service may be another than before. Without a reply
// the test fails.
ControlReply CallRun(const std::string& session, const control::Request& request);
// `troupe ctl` on a run of TestDomain().
Finished Ctl(const std::string& session, const std::vector<std::string>& action);

// Its running children whose command lines contain `part`.
std::vector<pid_t> ChildrenWith(const Program& program, const std::string& part);

}  // namespace troupe::test
