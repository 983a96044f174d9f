// The processes of a barrier benchmark, and their cost. The barrier benchmarks measure what lockstep costs at least
// over a way of communication (shared memory, UDP, DDS) with processes that only answer: what the simulator adds is the
// difference to these.
//
// Times are processor time per robot and tick where possible: wall time on a busy machine measures the neighbours.
#pragma once

#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace troupe::bench {

using Clock = std::chrono::steady_clock;

inline double Since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// The child runs the function and ends. Children die with this program.
template <typename Function>
pid_t Fork(Function function) {
  std::fflush(nullptr);
  const pid_t pid = fork();
  if (pid != 0) return pid;
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  function();
  _exit(0);
}

inline void WaitForAll(const std::vector<pid_t>& children) {
  for (const pid_t pid : children) waitpid(pid, nullptr, 0);
}

// A number from /proc/<pid>/status; 0 if it is missing.
inline long StatusNumber(pid_t pid, const std::string& key) {
  std::ifstream file("/proc/" + std::to_string(pid) + "/status");
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with(key + ":")) return std::atol(line.c_str() + key.size() + 1);
  }
  return 0;
}

// Processor time of all threads of this process and the others, s. Unlike wall time it is meaningful on a busy
// machine.
inline double ProcessorTime(std::vector<pid_t> processes) {
  processes.push_back(getpid());
  double nanoseconds = 0.0;
  for (const pid_t pid : processes) {
    const std::filesystem::path tasks = "/proc/" + std::to_string(pid) + "/task";
    for (const auto& task : std::filesystem::directory_iterator(tasks)) {
      std::ifstream file(task.path() / "schedstat");
      double running = 0.0;
      file >> running;
      nanoseconds += running;
    }
  }
  return nanoseconds * 1e-9;
}

struct BarrierOptions {
  int agents = 100;
  std::uint64_t ticks = 1000;
  int observers = 0;
  bool data_sharing = true;
};

// "[agents] [ticks] [observers] [on|off]" from the command line; ends the program if they are not valid.
inline BarrierOptions ParseBarrierOptions(int argc, char** argv) {
  BarrierOptions options;
  if (argc > 1) options.agents = std::atoi(argv[1]);
  if (argc > 2) options.ticks = static_cast<std::uint64_t>(std::atoll(argv[2]));
  if (argc > 3) options.observers = std::atoi(argv[3]);
  if (argc > 4) options.data_sharing = std::string(argv[4]) != "off";
  const bool valid = options.agents >= 1 && options.agents <= 1000 && options.ticks >= 1 && options.observers >= 0 &&
                     options.observers <= 100;
  if (valid) return options;
  std::fprintf(stderr, "expected 1 to 1000 agents, ticks from 1, and at most 100 observers\n");
  std::exit(2);
}

// Bytes on the wire of a frame in which all robots drive, and of a proposal; the benchmarks send messages of this size.
inline std::size_t FrameBytes(int robots) {
  return 300 + 40 * static_cast<std::size_t>(robots);
}
inline constexpr std::size_t kProposalBytes = 160;

}  // namespace troupe::bench
