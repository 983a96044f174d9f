// WorkerPool: requests answered by copies (fork) of this process, several at once. A copy that dies spoils its request
// only.
//
// Processes and not threads, because a case runs native controllers of users: a crash or exit in one of them must be
// the outcome of that case. Forked, not executed again: copies share the pages of worlds and bitmaps that were loaded
// before. fork() is safe only without other threads, hence the requirement. Copies are killed by the kernel when this
// process dies (PR_SET_PDEATHSIG), so that no case outlives a killed session.
//
// Order of replies is not defined: callers must not let results depend on it. A copy answers one request after another
// and is not renewed between them: work must leave nothing behind.
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "troupe/result.h"

namespace troupe {

class WorkerPool {
 public:
  // Answers a request, in a copy of this process that was made when the pool began, or when another copy had died.
  using Work = std::function<std::string(const std::string& request)>;

  // REQUIRES: this process has no other thread while the pool exists.
  WorkerPool(std::size_t jobs, Work work);
  ~WorkerPool();  // terminates all copies
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  // The next request; nothing: there is none, until another one is done.
  using Next = std::function<std::optional<std::string>()>;
  // The reply to a request. The error says how the copy died.
  using Done = std::function<void(const std::string& request, const Result<std::string>& reply)>;

  // Calls `next` whenever a copy is free, and `done` for each request, in the order of their ends, until there is none.
  // Ends earlier, and terminates the copies, once `stop` returns true: it is called whenever `stop_descriptor`, unless
  // -1, is readable. False: it was stopped. The error: no copy can be made.
  Result<bool> Run(const Next& next, const Done& done, int stop_descriptor = -1,
                   const std::function<bool()>& stop = nullptr);

 private:
  struct Worker {
    pid_t pid = -1;
    int descriptor = -1;                 // of the socket to it
    std::optional<std::string> request;  // nothing: it is free
    std::string received;                // of the reply
  };

  Status Start(Worker& worker);
  void Terminate(Worker& worker);
  // The reply, once it is whole; the error of a worker that has died.
  std::optional<Result<std::string>> Receive(Worker& worker);

  Work work_;
  std::vector<Worker> workers_;
};

}  // namespace troupe
