#include "testing/cases/worker_pool.h"

#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstring>

#include "common/base/file.h"
#include "common/base/system_error.h"

namespace troupe {
namespace {

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

// A terminal's Ctrl-C reaches the whole process group; the parent decides.
void ResetSignals() {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  signal(SIGINT, SIG_IGN);
  signal(SIGPIPE, SIG_IGN);
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
}

}  // namespace

WorkerPool::WorkerPool(std::size_t jobs, Work work)
    : work_(std::move(work)), workers_(std::max<std::size_t>(jobs, 1)) {}

WorkerPool::~WorkerPool() {
  for (Worker& worker : workers_) Terminate(worker);
}

Status WorkerPool::Start(Worker& worker) {
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
    for (const Worker& other : workers_) {
      // Sockets of older copies came along with fork: an open end here would hide from them that the parent has died.
      if (other.descriptor >= 0) close(other.descriptor);
    }
    while (const std::optional<std::string> request = ReceiveMessage(ends[1])) {
      if (!SendMessage(ends[1], work_(*request))) break;
    }
    std::fflush(nullptr);
    _exit(0);
  }
  close(ends[1]);
  worker = {pid, ends[0], std::nullopt, {}};
  return {};
}

void WorkerPool::Terminate(Worker& worker) {
  if (worker.pid < 0) return;
  kill(worker.pid, SIGKILL);
  while (waitpid(worker.pid, nullptr, 0) < 0 && errno == EINTR) {
  }
  close(worker.descriptor);
  worker = {};
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
  int status = 0;
  while (waitpid(worker.pid, &status, 0) < 0 && errno == EINTR) {
  }
  close(worker.descriptor);
  worker.pid = -1;
  worker.descriptor = -1;
  worker.received.clear();
  if (!WIFSIGNALED(status)) {
    return Result<std::string>(
        Failure("the process of the case ended with exit status " + std::to_string(WEXITSTATUS(status))));
  }
  const int signal = WTERMSIG(status);
  return Result<std::string>(Failure("the process of the case was killed by signal " + std::to_string(signal) + " (" +
                                     strsignal(signal) + ")"));
}

Result<bool> WorkerPool::Run(const Next& next, const Done& done, int stop_descriptor,
                             const std::function<bool()>& stop) {
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
    if (poll(waited.data(), waited.size(), -1) < 0 && errno != EINTR) return SystemError("poll");
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
  }
}

}  // namespace troupe
