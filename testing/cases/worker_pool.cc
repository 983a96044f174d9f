#include "testing/cases/worker_pool.h"

#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <new>
#include <system_error>
#include <utility>

#include "common/base/file.h"
#include "common/base/system_error.h"

namespace troupe {
namespace {

constexpr int kWatchMilliseconds = 100;  // from one look at the progress of copies to the next

// A message: the number of its bytes, then these.
bool SendMessage(int descriptor, const std::string& text) {
  const auto size = static_cast<std::uint32_t>(text.size());
  std::string bytes(sizeof size, '\0');
  std::memcpy(bytes.data(), &size, sizeof size);
  return WriteAll(descriptor, bytes + text);
}

bool ReadAll(int descriptor, char* bytes, std::size_t size) {
  while (size > 0) {
    const ssize_t got = read(descriptor, bytes, size);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    bytes += got;
    size -= static_cast<std::size_t>(got);
  }
  return true;
}

std::optional<std::string> ReceiveMessage(int descriptor) {
  std::uint32_t size = 0;
  if (!ReadAll(descriptor, reinterpret_cast<char*>(&size), sizeof size)) return std::nullopt;
  std::string text(size, '\0');
  if (!ReadAll(descriptor, text.data(), size)) return std::nullopt;
  return text;
}

// A terminal's Ctrl-C reaches the whole process group, as the signals of `timeout` do; the parent decides.
void ResetSignals() {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  for (const int each : {SIGHUP, SIGINT, SIGPIPE, SIGTERM}) signal(each, SIG_IGN);
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
}

struct Copy {
  pid_t pid = -1;
  int descriptor = -1;  // of the socket to it
};

// A copy of this process that calls `work` with its end of the socket, and ends.
template <typename Work>
Result<Copy> StartCopy(const Work& work) {
  std::array<int, 2> ends{};
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) return FileError("", ErrorCode::kFailure);
  std::fflush(nullptr);  // the copy must not print it again
  const pid_t parent = getpid();
  const pid_t pid = fork();
  if (pid < 0) {
    const Error error = SystemError("cannot start a process");
    close(ends[0]);
    close(ends[1]);
    return error;
  }
  if (pid == 0) {
    ResetSignals();
    // The parent may have died between fork and prctl: then the kernel sends nothing any more.
    if (getppid() != parent) _exit(0);
    close(ends[0]);
    work(ends[1]);
    std::fflush(nullptr);
    _exit(0);
  }
  close(ends[1]);
  return Copy{pid, ends[0]};
}

// Waits for a copy that has closed its socket.
Error EndOf(pid_t pid, int descriptor) {
  int status = 0;
  while (waitpid(pid, &status, 0) < 0 && errno == EINTR) {
  }
  close(descriptor);
  if (!WIFSIGNALED(status)) {
    return Failure("the process of the case ended with exit status " + std::to_string(WEXITSTATUS(status)));
  }
  const int signal = WTERMSIG(status);
  return Failure("the process of the case was killed by signal " + std::to_string(signal) + " (" + strsignal(signal) +
                 ")");
}

}  // namespace

Result<std::string> RunInCopy(const std::function<std::string()>& work) {
  const Result<Copy> copy = StartCopy([&](int descriptor) { SendMessage(descriptor, work()); });
  if (!copy.ok()) return copy.error();
  std::optional<std::string> reply = ReceiveMessage(copy.value().descriptor);
  const Error end = EndOf(copy.value().pid, copy.value().descriptor);
  if (reply) return *std::move(reply);
  return end;
}

WorkerPool::WorkerPool(std::size_t jobs, Work work) : work_(std::move(work)), workers_(std::max<std::size_t>(jobs, 1)) {
  void* const memory =
      mmap(nullptr, workers_.size() * sizeof(Counts), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) throw std::system_error(errno, std::generic_category(), "memory of the workers");
  counts_ = static_cast<Counts*>(memory);
  for (std::size_t i = 0; i < workers_.size(); ++i) workers_[i].counts = new (counts_ + i) Counts{};
}

WorkerPool::~WorkerPool() {
  for (Worker& worker : workers_) Terminate(worker);
  munmap(counts_, workers_.size() * sizeof(Counts));
}

Status WorkerPool::Start(Worker& worker) {
  Counts* const counts = worker.counts;
  const ProgressFunction progress = [counts](WorkProgress made) {
    if (made == WorkProgress::kPart) counts->parts.fetch_add(1, std::memory_order_relaxed);
    counts->steps.fetch_add(1, std::memory_order_relaxed);
  };
  const Result<Copy> copy = StartCopy([&](int descriptor) {
    for (const Worker& other : workers_) {
      // Sockets of older copies came along with fork: an open end here would hide from them that the parent has died.
      if (other.descriptor >= 0) close(other.descriptor);
    }
    while (const std::optional<std::string> request = ReceiveMessage(descriptor)) {
      if (!SendMessage(descriptor, work_(*request, progress))) break;
    }
  });
  if (!copy.ok()) return copy.error();
  worker.pid = copy.value().pid;
  worker.descriptor = copy.value().descriptor;
  return {};
}

void WorkerPool::Terminate(Worker& worker) {
  if (worker.pid < 0) return;
  kill(worker.pid, SIGKILL);
  while (waitpid(worker.pid, nullptr, 0) < 0 && errno == EINTR) {
  }
  close(worker.descriptor);
  Counts* const counts = worker.counts;
  worker = Worker();
  worker.counts = counts;
}

std::optional<Result<std::string>> WorkerPool::Receive(Worker& worker) {
  std::array<char, 65536> bytes{};
  const ssize_t got = read(worker.descriptor, bytes.data(), bytes.size());
  if (got < 0 && errno == EINTR) return std::nullopt;
  if (got > 0) {
    // Only whole replies are returned; a busy copy has one request, so that nothing follows its reply.
    worker.received.append(bytes.data(), static_cast<std::size_t>(got));
    std::uint32_t size = 0;
    if (worker.received.size() < sizeof size) return std::nullopt;
    std::memcpy(&size, worker.received.data(), sizeof size);
    if (worker.received.size() < sizeof size + size) return std::nullopt;
    std::string reply = worker.received.substr(sizeof size);
    worker.received.clear();
    return Result<std::string>(std::move(reply));
  }
  const Error end = EndOf(worker.pid, worker.descriptor);
  worker.pid = -1;
  worker.descriptor = -1;
  worker.received.clear();
  return Result<std::string>(end);
}

std::optional<Error> WorkerPool::Watch(Worker& worker, double seconds, const WorkLimits& limits) {
  const std::uint32_t parts = worker.counts->parts.load(std::memory_order_relaxed);
  const std::uint32_t steps = worker.counts->steps.load(std::memory_order_relaxed);
  worker.part_seconds = std::exchange(worker.parts, parts) == parts ? worker.part_seconds + seconds : 0.0;
  worker.step_seconds = std::exchange(worker.steps, steps) == steps ? worker.step_seconds + seconds : 0.0;
  if (limits.part && worker.part_seconds > *limits.part) {
    return Failure(fmt::format("the case has not ended within {:g} s", *limits.part));
  }
  if (limits.step && worker.step_seconds > *limits.step) {
    return Failure(fmt::format("a tick of the case has not ended within {:g} s", *limits.step));
  }
  return std::nullopt;
}

Result<bool> WorkerPool::Run(const Next& next, const Done& done, const WorkLimits& limits, int stop_descriptor,
                             const std::function<bool()>& stop) {
  const int longest_wait = limits.part || limits.step ? kWatchMilliseconds : -1;
  auto watched = std::chrono::steady_clock::now();
  for (;;) {
    std::vector<pollfd> waited = {{stop_descriptor, POLLIN, 0}};
    std::vector<Worker*> busy;
    for (Worker& worker : workers_) {
      while (!worker.request) {
        std::optional<std::string> request = next();
        if (!request) break;
        if (worker.pid < 0) {
          if (Status error = Start(worker); !error.ok()) return error.error();
        }
        if (SendMessage(worker.descriptor, *request)) {
          worker.request = std::move(request);
          worker.part_seconds = worker.step_seconds = 0.0;
        } else {
          Terminate(worker);
          done(*request, Failure("the process of the case has ended"));
        }
      }
      if (!worker.request) continue;
      waited.push_back({worker.descriptor, POLLIN, 0});
      busy.push_back(&worker);
    }
    if (busy.empty()) return true;
    // A descriptor of -1 is ignored by poll, so no stop descriptor needs no case of its own.
    if (poll(waited.data(), waited.size(), longest_wait) < 0 && errno != EINTR) return SystemError("poll");
    if (waited[0].revents != 0 && stop && stop()) {
      for (Worker& worker : workers_) Terminate(worker);
      return false;
    }
    for (std::size_t i = 0; i < busy.size(); ++i) {
      if (waited[i + 1].revents == 0) continue;
      const std::optional<Result<std::string>> reply = Receive(*busy[i]);
      if (!reply) continue;
      const std::string request = *busy[i]->request;
      busy[i]->request.reset();
      // The worker is free before the call: after `done` there may be requests again.
      done(request, *reply);
    }
    if (longest_wait < 0) continue;
    const auto now = std::chrono::steady_clock::now();
    // A longer time is one in which this process was stopped, and its copies most likely, too.
    const double passed =
        std::min(std::chrono::duration<double>(now - std::exchange(watched, now)).count(), 4e-3 * kWatchMilliseconds);
    for (Worker& worker : workers_) {
      if (!worker.request) continue;
      const std::optional<Error> late = Watch(worker, passed, limits);
      if (!late) continue;
      const std::string request = *worker.request;
      Terminate(worker);
      done(request, *late);
    }
  }
}

}  // namespace troupe
