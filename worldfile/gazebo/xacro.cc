// The program xacro, which expands the macros of robot files. They may be any Python, so that it is asked first, and
// ExpandXacro is for machines without it.
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>

#include "worldfile/gazebo/urdf_file.h"
#include "worldfile/text/text_file.h"

extern char** environ;

namespace troupe {

#ifdef __EMSCRIPTEN__

// There are no programs in a page.
Result<std::optional<std::string>> RunXacro(const std::string& /*path*/) {
  return std::optional<std::string>();
}

#else

namespace {

constexpr std::chrono::seconds kXacroTimeout{60};
constexpr std::size_t kMaxXacroError = 2'000;  // bytes of its message

struct Outcome {
  std::string output;
  std::string error;
  bool is_in_time = true;
};

// Reads both pipes until their ends.
Outcome ReadPipes(int output, int error) {
  Outcome outcome;
  const auto deadline = std::chrono::steady_clock::now() + kXacroTimeout;
  std::array<pollfd, 2> pipes = {pollfd{output, POLLIN, 0}, pollfd{error, POLLIN, 0}};
  int open = 2;
  while (open > 0) {
    const auto left =
        std::chrono::duration_cast<std::chrono::milliseconds>(deadline - std::chrono::steady_clock::now()).count();
    if (left <= 0 || outcome.output.size() > kMaxTextFileBytes) {
      outcome.is_in_time = false;
      break;
    }
    if (poll(pipes.data(), pipes.size(), static_cast<int>(left)) < 0 && errno != EINTR) break;
    for (pollfd& pipe : pipes) {
      if (pipe.fd < 0 || (pipe.revents & (POLLIN | POLLHUP | POLLERR)) == 0) continue;
      std::array<char, 65536> bytes;
      const ssize_t count = read(pipe.fd, bytes.data(), bytes.size());
      if (count <= 0) {
        pipe.fd = -1;
        --open;
        continue;
      }
      std::string& text = pipe.fd == output ? outcome.output : outcome.error;
      text.append(bytes.data(), static_cast<std::size_t>(count));
      if (&text == &outcome.error && text.size() > kMaxXacroError) text.resize(kMaxXacroError);
    }
  }
  return outcome;
}

}  // namespace

Result<std::optional<std::string>> RunXacro(const std::string& path) {
  const auto failure = [&](const std::string& message) { return Error{{path}, message}; };
  std::array<int, 2> output{};
  std::array<int, 2> error{};
  if (pipe2(output.data(), O_CLOEXEC) != 0) return failure("no pipe could be made");
  if (pipe2(error.data(), O_CLOEXEC) != 0) {
    close(output[0]);
    close(output[1]);
    return failure("no pipe could be made");
  }
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, output[1], STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, error[1], STDERR_FILENO);
  std::string program = "xacro";
  std::string argument = path;
  std::array<char*, 3> arguments = {program.data(), argument.data(), nullptr};
  pid_t child = 0;
  const int spawned = posix_spawnp(&child, program.c_str(), &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(output[1]);
  close(error[1]);
  Outcome outcome;
  int status = 0;
  if (spawned == 0) {
    outcome = ReadPipes(output[0], error[0]);
    if (!outcome.is_in_time) kill(child, SIGKILL);
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
  }
  close(output[0]);
  close(error[0]);
  if (spawned != 0 || (WIFEXITED(status) && WEXITSTATUS(status) == 127)) {
    return std::optional<std::string>();
  }
  if (!outcome.is_in_time) return failure("'xacro' did not end within 60 s and 64 MB, expected URDF");
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    return failure("'xacro' failed, expected URDF: " + Quoted(outcome.error, 500));
  }
  return std::optional(std::move(outcome.output));
}

#endif

}  // namespace troupe
