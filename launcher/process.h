// Process: a child program that cannot outlive this one. It gets SIGKILL from the kernel when the thread that started
// it ends, however that happens, so start it from a thread that lives as long as the program. It has a process group of
// its own: a terminal's Ctrl-C reaches only the parent, which then stops its children in order.
#pragma once

#include <sys/types.h>

#include <optional>
#include <string>
#include <vector>

#include "common/base/result.h"

namespace troupe {

// How a child ended.
struct ProcessEnd {
  int exit_code = 0;             // 128 + signal if a signal ended it, as shells count
  int signal = 0;                // 0: it ended by itself
  double peak_memory_mib = 0.0;  // largest resident size

  bool ok() const { return exit_code == 0; }
  // "ended with exit status 3", "was killed by signal 9 (Killed)"
  std::string ToString() const;
};

// Where a program finds itself in memory. At random addresses each process is strange to the processor, which predicts
// jumps by address; many processes of one program that take turns are faster when they all have the same.
// docs/performance.md has figures. It is harder to attack what has random ones, so only use the same where no stranger
// can send anything.
enum class Addresses : bool { kRandom, kSame };

class Process {
 public:
  // Descriptors for a child.
  struct Streams {
    int input = -1;  // -1: empty
    int output = -1;
    int error = -1;
  };

  // Runs command[0] (a path) with the rest as arguments. Its standard input is empty; what it says on standard output
  // and standard error goes to `output`. `kept`, unless -1, stays open in the child under its number.
  static Result<Process> Start(const std::vector<std::string>& command, int output, int kept = -1,
                               Addresses addresses = Addresses::kRandom) {
    return Start(command, {-1, output, output}, kept, addresses);
  }
  static Result<Process> Start(const std::vector<std::string>& command, const Streams& streams, int kept = -1,
                               Addresses addresses = Addresses::kRandom);

  Process(Process&& other) noexcept;
  Process& operator=(Process&& other) noexcept;
  ~Process();  // kills it if it still runs

  pid_t pid() const { return pid_; }
  bool running() const { return pid_ > 0 && !end_; }
  const std::optional<ProcessEnd>& end() const { return end_; }

  // Looks whether it has ended, without waiting. True once: when it is found to have ended.
  bool Poll();
  // Nothing if it has ended.
  void Signal(int signal) const;
  // SIGKILL to it and all of its group, and waits for its end.
  void Kill();

 private:
  explicit Process(pid_t pid) : pid_(pid) {}
  bool Wait(int options);

  pid_t pid_ = -1;
  std::optional<ProcessEnd> end_;
};

// The program `name` in the folder of the running program.
Result<std::string> FindProgram(const std::string& name);

}  // namespace troupe
