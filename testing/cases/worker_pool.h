// WorkerPool: requests answered by copies (fork) of this process, several at once. A copy that dies spoils its request
// only.
//
// Processes and not threads, because a case runs native controllers of users: a crash or exit in one of them must be
// the outcome of that case. Forked, not executed again: copies share the pages of worlds and bitmaps that were loaded
// before. fork() is safe only without other threads, hence the requirement. Copies are killed by the kernel when this
// process dies (PR_SET_PDEATHSIG), so that no case outlives a killed session.
//
// Order of replies is not defined: callers must not let results depend on it. A copy answers one request after another
// and is not renewed between them: work must leave nothing behind, and what may do so runs in a copy of its own
// (RunInCopy).
#pragma once

#include <sys/types.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "troupe/result.h"

namespace troupe {

// What work tells of its progress: each part that begins, a run of a simulation for instance, and each step within one.
enum class WorkProgress : std::uint8_t { kPart, kStep };
using ProgressFunction = std::function<void(WorkProgress)>;

// The result of the work, done in a copy of this process that ends then. The error says how the copy died. REQUIRES:
// this process has no other thread
Result<std::string> RunInCopy(const std::function<std::string()>& work);

// Wall times after which a copy is killed, s. A time during which this process was stopped does not count.
struct WorkLimits {
  std::optional<double> part = {};  // from the beginning of a part
  std::optional<double> step = {};  // from the last progress
};

class WorkerPool {
 public:
  // Answers a request, in a copy of this process that was made when the pool began, or when another copy had died.
  using Work = std::function<std::string(const std::string& request, const ProgressFunction& progress)>;

  // REQUIRES: this process has no other thread while the pool exists.
  WorkerPool(std::size_t jobs, Work work);
  ~WorkerPool();  // terminates all copies
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  // The next request; nothing: there is none, until another one is done.
  using Next = std::function<std::optional<std::string>()>;
  // The reply to a request. The error says how the copy died, or which limit it has passed.
  using Done = std::function<void(const std::string& request, const Result<std::string>& reply)>;

  // Calls `next` whenever a copy is free, and `done` for each request, in the order of their ends, until there is none.
  // Ends earlier, and terminates the copies, once `stop` returns true: it is called whenever `stop_descriptor`, unless
  // -1, is readable. False: it was stopped. The error: no copy can be made.
  Result<bool> Run(const Next& next, const Done& done, const WorkLimits& limits = {}, int stop_descriptor = -1,
                   const std::function<bool()>& stop = nullptr);

 private:
  // Shared with a copy, which counts.
  struct Counts {
    std::atomic<std::uint32_t> parts;
    std::atomic<std::uint32_t> steps;
  };
  struct Worker {
    pid_t pid = -1;
    int descriptor = -1;                 // of the socket to it
    std::optional<std::string> request;  // nothing: it is free
    std::string received;                // of the reply
    Counts* counts = nullptr;            // of the pool
    std::uint32_t parts = 0;             // as last seen
    std::uint32_t steps = 0;
    double part_seconds = 0.0;  // since they last changed
    double step_seconds = 0.0;
  };

  Status Start(Worker& worker);
  // Adds `seconds` to the times of a busy copy. The error of a limit that it has passed.
  static std::optional<Error> Watch(Worker& worker, double seconds, const WorkLimits& limits);
  void Terminate(Worker& worker);
  // The reply, once it is whole; the error of a worker that has died.
  std::optional<Result<std::string>> Receive(Worker& worker);

  Work work_;
  Counts* counts_ = nullptr;  // memory that is shared with all copies, one for each worker
  std::vector<Worker> workers_;
};

}  // namespace troupe
