// Host: starts processes of a run, on this host or on another one over a connection.
#pragma once

#include <sys/types.h>

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "launcher/process/line_pipe.h"
#include "launcher/process/process.h"
#include "troupe/result.h"

namespace troupe {

// A process of the run on some host.
class Child {
 public:
  virtual ~Child() = default;
  virtual pid_t pid() const = 0;  // on its host; 0: unknown
  virtual const std::optional<ProcessEnd>& end() const = 0;
  // Checks for its end, without waiting. True once, when the end is found.
  virtual bool Poll() = 0;
  // No effect on a process that has ended.
  virtual void Signal(int signal) = 0;
  // Kills the process: it has ended, or its host ends it.
  virtual void Kill() = 0;

  bool running() const { return !end(); }
};

// Told the bytes of a file that have been copied so far; false ends the copy.
using FetchProgress = std::function<bool(std::size_t bytes)>;

class Host {
 public:
  virtual ~Host() = default;

  virtual const std::string& name() const = 0;  // empty: the host of the launcher
  // The folder for output files of its processes; empty: they write to the paths that the user gave.
  virtual const std::string& folder() const = 0;
  virtual std::string ProgramPath(const std::string& program) const = 0;
  // `reports`: the process writes reports for the launcher (docs/tick-protocol.md).
  virtual Result<std::unique_ptr<Child>> Start(const std::string& program, const std::vector<std::string>& arguments,
                                               bool reports) = 0;

  // Makes the keys in the folder `enclave` of the folder `keys`, which is on the launcher's host, readable for
  // processes of this one; returns the folder `keys` here.
  virtual Result<std::string> PlaceKeys(const std::string& keys, const std::string& enclave) = 0;

  // Readable when there are new lines or ends of processes.
  virtual std::vector<int> descriptors() const = 0;
  // Reads what has arrived from a remote host: ends of processes, each after all lines of the process. Lines and ends
  // that arrive later are left for the next call.
  virtual void Receive() {}
  // The lines since the last call: printed by the processes, and reported by them.
  virtual std::vector<std::string> ReadOutput() = 0;
  virtual std::vector<std::string> ReadReports() = 0;
  // An error with the reason, once, when the connection is lost, or an attempt to connect again has failed.
  virtual Status PollLoss() { return Status(); }
  // Processes can be started.
  virtual bool connected() const { return true; }
  // Begins to connect again, to a host with a new folder and no processes. No effect on this host.
  virtual void Reconnect() {}
  // Copies the file `from` of this host to the path `to` on the launcher's host. At once an error if it is not
  // connected.
  virtual Status Fetch(const std::string& from, const std::string& to, const FetchProgress& progress) = 0;
};

// Starts processes as children of this one.
class LocalHost : public Host {
 public:
  // `agents`: the address layout of agents.
  explicit LocalHost(Addresses agents = Addresses::kRandom) : agent_addresses_(agents) {}

  const std::string& name() const override { return none_; }
  const std::string& folder() const override { return none_; }
  std::string ProgramPath(const std::string& program) const override;
  Result<std::unique_ptr<Child>> Start(const std::string& program, const std::vector<std::string>& arguments,
                                       bool reports) override;
  Result<std::string> PlaceKeys(const std::string& keys, const std::string&) override { return keys; }
  std::vector<int> descriptors() const override;
  std::vector<std::string> ReadOutput() override { return output_.Read(); }
  std::vector<std::string> ReadReports() override { return reports_.Read(); }
  Status Fetch(const std::string& from, const std::string& to, const FetchProgress& progress) override;

 private:
  const Addresses agent_addresses_;
  const std::string none_;
  LinePipe output_;
  LinePipe reports_;
};

}  // namespace troupe
