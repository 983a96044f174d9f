#include "launcher/process/process.h"

#include <fcntl.h>
#include <string.h>
#include <sys/personality.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/signalfd.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <initializer_list>
#include <system_error>

#include "common/base/paths.h"
#include "common/base/system_error.h"

namespace troupe {
namespace {

constexpr int kUnknownExit = 255;

// Makes `from` the standard stream `to`, which stays open in the program.
void Connect(int from, int to) {
  if ((from == to ? fcntl(to, F_SETFD, 0) : dup2(from, to)) < 0) _exit(127);
}

// Between fork and exec: only calls that are async-signal-safe, because another thread of the parent may have held a
// lock (of the heap, say) at the fork, which no thread of the child will ever release.
[[noreturn]] void BecomeProgram(char* const* arguments, pid_t parent, const Process::Streams& streams, int kept,
                                Addresses addresses) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(127);  // the parent died before the line above
  setpgid(0, 0);
  // The launcher blocks the signals that it reads from a descriptor; a program inherits the mask, and would never see
  // Ctrl-C.
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  for (const int each : {SIGINT, SIGPIPE, SIGTERM}) signal(each, SIG_DFL);
  Connect(streams.output, STDOUT_FILENO);
  Connect(streams.error, STDERR_FILENO);
  if (streams.input >= 0) {
    Connect(streams.input, STDIN_FILENO);
  } else {
    close(STDIN_FILENO);  // so that there is a descriptor for the next line
    if (open("/dev/null", O_RDONLY) != STDIN_FILENO) _exit(127);
  }
  if (kept >= 0 && fcntl(kept, F_SETFD, 0) < 0) _exit(127);
  // Some containers forbid this; the process is then only slower.
  if (addresses == Addresses::kSame) personality(static_cast<unsigned long>(personality(~0u)) | ADDR_NO_RANDOMIZE);
  execv(arguments[0], arguments);
  for (const char* const text :
       {"error: cannot start ", const_cast<const char*>(arguments[0]), ": ", strerrordesc_np(errno), "\n"}) {
    if (text != nullptr && write(STDERR_FILENO, text, strlen(text)) < 0) break;
  }
  _exit(127);
}

}  // namespace

std::string ProcessEnd::ToString() const {
  if (unknown != 0) return std::string("ended in an unknown way (") + strerror(unknown) + ")";
  if (signal != 0) return "was killed by signal " + std::to_string(signal) + " (" + strsignal(signal) + ")";
  return "ended with exit status " + std::to_string(exit_code);
}

// fork and not posix_spawn: PR_SET_PDEATHSIG must be set in the child before exec.
Result<Process> Process::Start(const std::vector<std::string>& command, const Streams& streams, int kept,
                               Addresses addresses) {
  std::vector<char*> arguments;
  for (const std::string& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  pid_t parent = getpid();
  pid_t pid = fork();
  if (pid == 0) BecomeProgram(arguments.data(), parent, streams, kept, addresses);
  if (pid < 0) return SystemError("cannot start " + command[0]);
  setpgid(pid, pid);  // here too, so that the group exists before this returns
  return Process(pid);
}

Process::Process(Process&& other) noexcept : pid_(std::exchange(other.pid_, -1)), end_(other.end_) {}

Process& Process::operator=(Process&& other) noexcept {
  if (this != &other) {
    Kill();
    pid_ = std::exchange(other.pid_, -1);
    end_ = other.end_;
  }
  return *this;
}

Process::~Process() {
  Kill();
}

bool Process::Poll() {
  return running() && Wait(WNOHANG);
}

void Process::Signal(int signal) const {
  if (running()) kill(pid_, signal);
}

// The group first, as a grandchild would outlive its parent.
void Process::Kill() {
  if (!running()) return;
  kill(-pid_, SIGKILL);
  Wait(0);
}

// wait4 and not waitpid, for the resource usage.
bool Process::Wait(int options) {
  int status = 0;
  rusage usage{};
  pid_t found = 0;
  do {
    found = wait4(pid_, &status, options, &usage);
  } while (found < 0 && errno == EINTR);
  if (found == 0) return false;
  ProcessEnd end;
  if (found < 0) {
    end.unknown = errno;
    end.exit_code = kUnknownExit;
    end_ = end;
    return true;
  }
  end.peak_memory_mib = static_cast<double>(usage.ru_maxrss) / 1024.0;
  if (WIFSIGNALED(status)) end.signal = WTERMSIG(status);
  end.exit_code = end.signal != 0 ? 128 + end.signal : WEXITSTATUS(status);
  end_ = end;
  return true;
}

Result<std::string> FindProgram(const std::string& name) {
  const Result<std::string> folder = ProgramFolder();
  if (!folder.ok()) return folder.error();
  std::string path = folder.value() + "/" + name;
  if (access(path.c_str(), X_OK) != 0) {
    return Failure("cannot start " + path + ": " + strerror(errno) + "; expected it beside the program troupe");
  }
  return path;
}

LineReader::LineReader(int descriptor) : descriptor_(descriptor) {
  fcntl(descriptor_, F_SETFL, fcntl(descriptor_, F_GETFL) | O_NONBLOCK);
}

// Reads until the pipe is empty, so that one wake-up serves all lines.
std::vector<std::string> LineReader::Read() {
  while (!at_end_) {
    constexpr std::size_t kPiece = 65536;  // bytes; too many for a small stack (ulimit -s)
    const std::size_t before = partial_.size();
    partial_.resize(before + kPiece);
    const ssize_t size = read(descriptor_, partial_.data() + before, kPiece);
    const int reason = errno;
    partial_.resize(before + static_cast<std::size_t>(size > 0 ? size : 0));
    if (size < 0 && reason == EINTR) continue;
    if (size < 0 && reason == EAGAIN) break;
    at_end_ = size <= 0;  // what cannot be read has no more lines
  }
  if (at_end_ && !partial_.empty() && partial_.back() != '\n') partial_ += '\n';
  std::vector<std::string> lines;
  std::size_t begin = 0;
  for (std::size_t end; (end = partial_.find('\n', begin)) != std::string::npos; begin = end + 1) {
    lines.push_back(partial_.substr(begin, end - begin));
  }
  partial_.erase(0, begin);
  return lines;
}

LinePipe::Ends::Ends() {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) throw std::system_error(errno, std::generic_category(), "making a pipe");
  reading = ends[0];
  writing = ends[1];
}

// Only the reading end is non-blocking; children inherit the writing end.
LinePipe::LinePipe() : reader_(ends_.reading) {}

LinePipe::~LinePipe() {
  CloseWritingEnd();
  close(ends_.reading);
}

void LinePipe::CloseWritingEnd() {
  if (ends_.writing >= 0) close(std::exchange(ends_.writing, -1));
}

SignalWatch::SignalWatch() {
  sigset_t watched;
  sigemptyset(&watched);
  for (int signal : {SIGINT, SIGTERM, SIGHUP, SIGCHLD}) sigaddset(&watched, signal);
  descriptor_ = signalfd(-1, &watched, SFD_NONBLOCK | SFD_CLOEXEC);
  if (descriptor_ < 0) throw std::system_error(errno, std::generic_category(), "watching signals");
  // A parent may have left it ignored: then the ends of children would be neither reported nor kept.
  signal(SIGCHLD, SIG_DFL);
  pthread_sigmask(SIG_BLOCK, &watched, &before_);
}

SignalWatch::~SignalWatch() {
  close(descriptor_);
  pthread_sigmask(SIG_SETMASK, &before_, nullptr);
}

bool SignalWatch::ReadStopRequest() {
  bool stop = false;
  signalfd_siginfo info;
  while (read(descriptor_, &info, sizeof info) == static_cast<ssize_t>(sizeof info)) {
    const bool is_child = info.ssi_signo == static_cast<unsigned>(SIGCHLD);
    child_ended_ = child_ended_ || is_child;
    stop = stop || !is_child;
  }
  stop_requested_ = stop_requested_ || stop;
  return stop;
}

}  // namespace troupe
