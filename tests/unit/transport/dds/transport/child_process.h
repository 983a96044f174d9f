// ChildProcess: a program started by a test, which ends with it.
#pragma once

#include <sys/types.h>

#include <csignal>
#include <string>
#include <vector>

namespace troupe::test {

class ChildProcess {
 public:
  // `arguments[0]` is the program's path.
  explicit ChildProcess(const std::vector<std::string>& arguments);
  ~ChildProcess() { End(SIGKILL); }
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  void Signal(int signal) const { kill(pid_, signal); }
  // Sends the signal and waits until the process has ended.
  void End(int signal);

 private:
  pid_t pid_ = -1;
};

}  // namespace troupe::test
