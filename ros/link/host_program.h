// HostProgram: the program ros-participant of this host, for a process with nodes in ROS or the launcher of such
// processes. It connects to the program, and starts it where none listens: as soon as its last connection has ended,
// the program ends too. A program that dies is started again.
// Several processes start at once: each tries to connect, and one whose program finds the socket bound by another
// simply connects again, so that no lock file is needed. Reports come from a thread of its own, until the destructor.
#pragma once

#include <sys/types.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "common/base/wake_event.h"
#include "ros/messages/ros_options.h"
#include "troupe/result.h"

namespace troupe::ros {

// The name of the socket of a run's program, for processes that get no other one. With security each enclave has one.
std::string SocketOfSession(std::uint32_t simulation_domain, const std::string& session, const RosSecurity& security);
// One that no other run has.
std::string NewSocketName();

// The process of a program that is started with these arguments, beside the running one. It has the standard streams,
// and `descriptor` as its descriptor 3 if that is not negative. It is in a process group of its own, so that a
// terminal's Ctrl-C does not reach it. Fails without the program.
Result<pid_t> StartProgram(const std::string& path, const std::vector<std::string>& arguments, int descriptor = -1);

// "ended with exit status 3", "was killed by signal 9 (Killed)"; `status`: of waitpid.
std::string ToText(int status);

class HostProgram {
 public:
  // Whether the destructor waits for the end of a program that this has started. It kills one that takes seconds, so
  // REQUIRES for kAwait: no other process uses it any more.
  enum class AtEnd : std::uint8_t { kAwait, kLeave };

  // `report`: receives the ends of a program, one line each, on a thread of this or in its destructor.
  HostProgram(std::string socket, RosNetwork network, AtEnd at_end, std::function<void(const std::string&)> report);
  ~HostProgram();
  HostProgram(const HostProgram&) = delete;
  HostProgram& operator=(const HostProgram&) = delete;

  const std::string& socket() const { return socket_; }

  // Call once. Returns as soon as the program listens. The error is its end, of which it has written the reason.
  Status Start();

 private:
  using Clock = std::chrono::steady_clock;

  void Run(int connection);
  template <typename MakeText>
  void Report(const MakeText& make_text) const;
  // Kills it if it does not end in time.
  void AwaitChild() const;
  // The connection; nothing: at the stop request, or for the error.
  std::optional<int> Open(Status& error);
  // Whether the time has passed without a stop request.
  bool Wait(std::chrono::milliseconds time) const;

  const std::string socket_;
  const RosNetwork network_;
  const AtEnd at_end_;
  const std::function<void(const std::string&)> report_;
  const WakeEvent wake_;
  std::atomic<bool> stop_ = false;
  pid_t child_ = 0;  // 0: none. Of the thread while it runs
  std::thread thread_;
};

// Starts the program for a process without a socket in its options, and sets the options' socket. `own_enclave`: of the
// process, where the options name none.
Status StartForSession(std::uint32_t simulation_domain, const std::string& session, const std::string& own_enclave,
                       RosOptions& options, std::optional<HostProgram>& program,
                       std::function<void(const std::string&)> report);

}  // namespace troupe::ros
