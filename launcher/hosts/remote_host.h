// RemoteHost: starts processes on another host, over a connection to a `troupe host` there. The end of the connection,
// by whatever cause, terminates them.
//
// The connection is a program of the user's choice, ssh by default, with JSON lines on its standard streams (messages:
// host.h): so authentication and encryption are those that the user has set up, and no port has to be opened. `troupe
// host` ends all its processes at the end of its input; that is why a launcher that is killed leaves nothing behind on
// other machines either.
//
// A lost connection is not an error of the run: PollLoss says so once, and Reconnect begins again with an empty host.
// The processes there have ended, or are ended by the new `troupe host` (message "run").
#pragma once

#include <map>
#include <set>
#include <string_view>
#include <utility>

#include "common/run/run_settings.h"
#include "launcher/hosts/host.h"
#include "launcher/process/process.h"

namespace troupe {

class RemoteHost : public Host {
 public:
  // Starts the connection. connected() or PollLoss() returns its outcome later. `run`: a `troupe host` there that an
  // earlier connection of this run to this host has left ends with its processes.
  static Result<std::unique_ptr<RemoteHost>> Connect(const HostSettings& settings, const std::string& run);
  ~RemoteHost() override;  // terminates the processes and the connection

  // The host has answered: its programs are present, and of this version.
  bool connected() const override { return ready_ && !lost_; }
  void Reconnect() override;
  int Ping() override;

  const std::string& name() const override { return settings_.name; }
  const std::string& folder() const override { return folder_; }
  std::string ProgramPath(const std::string& program) const override { return programs_ + "/" + program; }
  Result<std::unique_ptr<Child>> Start(const std::string& program, const std::vector<std::string>& arguments,
                                       bool reports) override;
  Result<std::string> PlaceKeys(const std::string& keys, const std::string& enclave) override;
  std::vector<int> descriptors() const override;
  void Receive() override { Read(); }
  std::vector<std::string> ReadOutput() override { return std::exchange(output_, {}); }
  std::vector<std::string> ReadReports() override { return std::exchange(reports_, {}); }
  Status PollLoss() override;
  Status Fetch(const std::string& from, const std::string& to, const FetchProgress& progress) override;

 private:
  struct State {  // of a process
    pid_t pid = 0;
    std::optional<ProcessEnd> end;
    bool reported = false;  // Poll has returned true
  };
  struct FileFetch {
    std::string source;  // path there
    int target = -1;     // descriptor here
    std::size_t bytes = 0;
    bool complete = false;
    std::string error;
  };
  class RemoteChild;

  RemoteHost(const HostSettings& settings, std::string command, std::string run);
  Status Open();
  void Read();
  void ReadErrors();
  void ApplyMessage(const std::string& line);
  void ApplyMessage(const JsonReader& message);
  State* ChildIn(const JsonReader& message, const char* key);
  void Lose(const std::string& reason);
  void Send(std::string_view line);  // reads messages while the host takes no requests

  const HostSettings settings_;
  const std::string command_;  // opens the connection
  const std::string run_;
  // Of the newest connection.
  std::unique_ptr<LinePipe> messages_;
  std::unique_ptr<LinePipe> errors_;
  int requests_ = -1;
  std::optional<Process> connection_;
  bool is_first_ = true;
  bool ready_ = false;
  bool lost_ = false;
  int pings_ = 0;  // since a sign of life is owed
  Status loss_;
  std::string folder_;
  std::string programs_;
  std::map<int, std::shared_ptr<State>> children_;
  std::vector<std::string> output_;
  std::vector<std::string> reports_;
  std::string last_error_line_;
  std::optional<FileFetch> fetch_;  // during Fetch
  std::set<std::string> enclaves_;  // whose keys were sent
};

}  // namespace troupe
