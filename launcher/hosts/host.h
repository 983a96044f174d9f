// Host: starts processes of a run, on this host or on another one over a connection.
//
// The supervisor knows only this interface, so a run on one machine and one on ten have the same code. Differences that
// remain: a remote host may be lost and connected again, has a folder of its own for output files, and needs keys to be
// copied.
//
// Called by one thread, the supervisor's. Reading never waits; Fetch waits for the file and reports progress, and a
// request to a remote host waits while its pipe is full. The order that callers rely on: the end of a process comes
// after all of its lines.
#pragma once

#include <sys/types.h>

#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/base/json_reader.h"
#include "common/base/locked_folder.h"
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
  // Writes a line to its standard input, now or later. No effect on a process that was started without reports, or has
  // ended.
  virtual void Tell(const std::string& line) = 0;
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
  // `reports`: the process writes reports for the launcher, and reads its news (docs/tick-protocol.md).
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
  // Asks a remote host for a sign of life, unless it still owes one. The number of calls since it owes it; 0: none.
  virtual int Ping() { return 0; }
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

// The messages between a launcher and `troupe host` on another host: one JSON object a line.
//
// To the host, on its standard input; the end of the input terminates all processes that were started:
//   {"start": id, "program": name, "arguments": [..], "reports": bool}    {"signal": id, "number": n}    {"read": path}
//   {"tell": id, "line": text}    a line for the standard input of a process with reports    {"ping": true}
//   {"run": name}    first: a host of that name whose connection was cut, and which has not noticed, is to end
//   {"key": path, "data": hexadecimal}    a file below the host's folder of keys
// From the host, on its standard output:
//   {"host": version, "folder": path, "programs": path}         first; the folder is for output, and is deleted at the
//   end
//   {"started": id, "pid": n}    {"failed": id, "message": text}    {"pong": true}
//   {"output": line}    {"report": line}
//   {"ended": id, "exit_code": n, "signal": n, "peak_memory_mib": x}      after all of its lines
//   {"file": path, "data": hexadecimal}    {"file": path, "end": true}    {"file": path, "error": text}

// The folder of keys in the host's folder.
inline constexpr const char* kKeysFolderOfHost = "keys";

using HostMessage = nlohmann::json;

// One line with its end. Bytes that are not UTF-8 are replaced.
std::string ToLine(const HostMessage& message);

// The reader of a line. It has an error if the line is not a message.
JsonReader ReadHostMessage(const std::string& line);
// Bytes in a member, as hexadecimal digits; empty after an error.
std::string BytesIn(const JsonReader& message, const char* key);

// Quoting of words and command lines for a shell.

// A word as a shell reads it.
std::string ShellQuoted(const std::string& word);

// A command line for a shell.
std::string ShellQuoted(const std::vector<std::string>& words);

// `text` with each "{name}" of `values` replaced by its value; other braces stay.
std::string FillIn(const std::string& text, const std::map<std::string, std::string>& values);

// HostFolder: the temporary folder of `troupe host`, for keys and for files of its processes: troupe-host-PID-XXXXXX.
class HostFolder {
 public:
  // Makes it, and deletes the folders of this user's hosts that were killed.
  HostFolder();

  // Of the hosts of this user with folders beside this one, those that serve the same name end, with all processes that
  // they started: a launcher has lost its connection to them.
  void TakeOver(const std::string& name);

  // Empty if it could not be made.
  const std::string& path() const { return folder_.path(); }

 private:
  LockedFolder folder_;
};

}  // namespace troupe
