#include "launcher/process/filter.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

namespace troupe {
namespace {

constexpr int kPollMilliseconds = 20;

// A descriptor that is closed at the end.
class OwnDescriptor {
 public:
  explicit OwnDescriptor(int descriptor) : descriptor_(descriptor) {}
  ~OwnDescriptor() { Close(); }
  OwnDescriptor(const OwnDescriptor&) = delete;
  OwnDescriptor& operator=(const OwnDescriptor&) = delete;
  int get() const { return descriptor_; }
  void Close() {
    if (descriptor_ >= 0) close(std::exchange(descriptor_, -1));
  }

 private:
  int descriptor_;
};

Error SystemFailure(const char* what) {
  return Failure(std::string(what) + ": " + std::strerror(errno));
}

// A file without a name: the command may read as late as it wants.
bool WriteAll(int file, const std::string& text) {
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t written = write(file, text.data() + done, text.size() - done);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    done += static_cast<std::size_t>(written);
  }
  return lseek(file, 0, SEEK_SET) == 0;
}

}  // namespace

Result<std::string> RunFilter(const std::string& command, const std::string& input, SignalWatch& signals) {
  const OwnDescriptor given(memfd_create("troupe-filter", MFD_CLOEXEC));
  if (given.get() < 0 || !WriteAll(given.get(), input)) return SystemFailure("cannot keep the input of a command");
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) return SystemFailure("cannot make a pipe");
  const OwnDescriptor reading(ends[0]);
  OwnDescriptor writing(ends[1]);
  Result<Process> process = Process::Start({"/bin/sh", "-c", command}, {given.get(), writing.get(), STDERR_FILENO});
  if (!process.ok()) return process.error();
  writing.Close();
  std::string output;
  std::array<char, 65536> part{};
  while (true) {
    std::array<pollfd, 2> waited = {{{reading.get(), POLLIN, 0}, {signals.descriptor(), POLLIN, 0}}};
    if (poll(waited.data(), waited.size(), -1) < 0 && errno != EINTR) return SystemFailure("cannot wait for a command");
    if (signals.ReadStopRequest()) return Failure("the command '" + command + "' was stopped");
    if (waited[0].revents == 0) continue;
    const ssize_t got = read(reading.get(), part.data(), part.size());
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) break;
    output.append(part.data(), static_cast<std::size_t>(got));
    if (output.size() > kMaxFilterBytes) {
      return BadInput("the command '" + command + "' wrote more than " + std::to_string(kMaxFilterBytes) +
                      " bytes, expected a file of paths");
    }
  }
  // It has closed its output; its end follows.
  while (!process.value().Poll()) {
    pollfd waited = {signals.descriptor(), POLLIN, 0};
    poll(&waited, 1, kPollMilliseconds);
    if (signals.ReadStopRequest()) return Failure("the command '" + command + "' was stopped");
  }
  const ProcessEnd& end = *process.value().end();
  if (!end.ok()) return BadInput("the command '" + command + "' " + end.ToString() + ", expected exit status 0");
  return output;
}

}  // namespace troupe
