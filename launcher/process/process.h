// Child processes, lines from their pipes, and signals.
//
// The promise behind this file: no process of a run is left behind, however the launcher ends. Three means work
// together. The kernel kills a child when its parent's thread dies (PR_SET_PDEATHSIG); each child leads a process
// group, so that grandchildren are killed with it; and a Process object kills and reaps its child in its destructor.
//
// Everything is read without waiting: one loop polls all pipes and the signal descriptor, and no thread per child is
// needed. Errors: without descriptors, constructors throw std::system_error; starting a program returns its error. A
// child that cannot execute its program ends with status 127, as in a shell.
#pragma once

#include <signal.h>
#include <sys/types.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "troupe/result.h"

namespace troupe {

// How a child ended.
struct ProcessEnd {
  int exit_code = 0;             // 128 + signal if a signal ended it, as shells count; 255 if it is unknown
  int signal = 0;                // 0: it ended by itself
  double peak_memory_mib = 0.0;  // largest resident size
  int unknown = 0;               // not 0: the system has reported the end, but not how; of errno

  bool ok() const { return exit_code == 0; }
  // "ended with exit status 3", "was killed by signal 9 (Killed)", "ended in an unknown way (No child processes)"
  std::string ToString() const;
};

// The address layout of a program. The processor predicts branches by address, so many processes of one program that
// run in turn are faster with equal addresses; docs/performance-trials.md has figures. Random addresses make attacks
// harder, so REQUIRES: kSame only where other hosts cannot send to the process.
enum class Addresses : bool { kRandom, kSame };

// Process: a child program that cannot outlive this one. The kernel sends it SIGKILL when the thread that started it
// ends, by whatever cause, so REQUIRES: that thread lives as long as the program. The child has its own process group:
// a terminal's Ctrl-C reaches only the parent, which then stops its children in order.
class Process {
 public:
  // Descriptors for a child.
  struct Streams {
    int input = -1;  // -1: empty
    int output = -1;
    int error = -1;
  };

  // Runs command[0] (a path) with the rest as arguments. Its standard input is empty; its standard output and
  // standard error are connected to `output`. The descriptor `kept`, unless -1, stays open in the child.
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

  // Checks for its end, without waiting. True once, when the end is found.
  bool Poll();
  // No effect on a process that has ended.
  void Signal(int signal) const;
  // Sends SIGKILL to its process group, and waits for its end.
  void Kill();

 private:
  explicit Process(pid_t pid) : pid_(pid) {}
  bool Wait(int options);

  pid_t pid_ = -1;
  std::optional<ProcessEnd> end_;
};

// The program `name` in the folder of the running program.
Result<std::string> FindProgram(const std::string& name);

// LineReader and LinePipe: lines from pipes, read without waiting.

class LineReader {
 public:
  // Makes the descriptor non-blocking. Does not own it.
  explicit LineReader(int descriptor);

  // The lines completed since the last call; at the end of the input, or if it cannot be read any more, also an
  // unfinished one.
  std::vector<std::string> Read();
  bool at_end() const { return at_end_; }

 private:
  int descriptor_;
  bool at_end_ = false;
  std::string partial_;
};

// A pipe that children write lines into and this process reads.
class LinePipe {
 public:
  // Throws std::system_error without resources.
  LinePipe();
  ~LinePipe();
  LinePipe(const LinePipe&) = delete;
  LinePipe& operator=(const LinePipe&) = delete;

  int reading_end() const { return ends_.reading; }
  // For children. Closed in this process by CloseWritingEnd, so that the pipe ends with the last child.
  int writing_end() const { return ends_.writing; }
  void CloseWritingEnd();

  std::vector<std::string> Read() { return reader_.Read(); }
  bool at_end() const { return reader_.at_end(); }

 private:
  struct Ends {
    Ends();
    int reading = -1;
    int writing = -1;
  };

  Ends ends_;
  LineReader reader_;
};

// SignalWatch: makes this process's signals readable from a descriptor. During its lifetime SIGINT, SIGTERM, SIGHUP and
// SIGCHLD have no other effect. REQUIRES: constructed before any other thread starts, so that all threads inherit the
// signal mask.
class SignalWatch {
 public:
  // Throws std::system_error without resources.
  SignalWatch();
  ~SignalWatch();
  SignalWatch(const SignalWatch&) = delete;
  SignalWatch& operator=(const SignalWatch&) = delete;

  // Readable when a signal is pending.
  int descriptor() const { return descriptor_; }
  // Consumes all pending signals. True if one of them requests a stop.
  bool ReadStopRequest();
  // Whether ReadStopRequest has read since the last call that a child of this process has ended.
  bool ReadChildEnd() { return std::exchange(child_ended_, false); }
  // Whether ReadStopRequest has ever returned true.
  bool stop_requested() const { return stop_requested_; }

 private:
  sigset_t before_;
  int descriptor_ = -1;
  bool stop_requested_ = false;
  bool child_ended_ = false;
};

}  // namespace troupe
