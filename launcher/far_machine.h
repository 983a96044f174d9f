// FarMachine: processes on another machine, over a connection to a `troupe host` there. When the connection ends,
// however that happens, so do they.
#pragma once

#include <chrono>
#include <map>

#include "common/worldfile/host_settings.h"
#include "launcher/line_pipe.h"
#include "launcher/machine.h"
#include "launcher/signal_watch.h"

namespace troupe {

class FarMachine : public Machine {
 public:
  // Opens the connection; whether it stands shows later.
  static Result<std::unique_ptr<FarMachine>> Connect(const HostSettings& settings);
  ~FarMachine() override;  // ends all there is

  // Its programs are found, and of this version.
  bool ready() const { return ready_; }

  const std::string& name() const override { return settings_.name; }
  const std::string& folder() const override { return folder_; }
  std::string ProgramPath(const std::string& program) const override { return programs_ + "/" + program; }
  Result<std::unique_ptr<Child>> Start(const std::string& program, const std::vector<std::string>& arguments,
                                       bool reports) override;
  std::vector<int> descriptors() const override;
  std::vector<std::string> TakeOutput() override;
  std::vector<std::string> TakeReports() override;
  Status TakeLoss() override;
  Status Fetch(const std::string& from, const std::string& to) override;

 private:
  struct State {  // of a process
    pid_t pid = 0;
    std::optional<ProcessEnd> end;
    bool told = false;  // the end, by Poll
  };
  class FarChild;

  FarMachine(const HostSettings& settings, std::string command);
  void Read();
  void HandleLine(const std::string& line);
  void Lose(const std::string& why);
  void Send(const std::string& line);

  const HostSettings settings_;
  const std::string command_;  // that opens the connection
  LinePipe messages_;
  LinePipe errors_;
  int requests_ = -1;
  std::optional<Process> connection_;
  bool ready_ = false;
  bool lost_ = false;
  Status loss_;
  std::string folder_;
  std::string programs_;
  std::map<int, std::shared_ptr<State>> children_;
  std::vector<std::string> output_;
  std::vector<std::string> reports_;
  std::string last_words_;
  // Of a file that is fetched.
  std::string file_;
  std::optional<bool> file_complete_;
  std::string file_error_;
  int file_target_ = -1;
};

// Connects to all, in the order given. The error names the host that could not be reached, or that has no programs or
// others. A signal to stop breaks the waiting off.
Result<std::vector<std::unique_ptr<FarMachine>>> ConnectAll(const std::vector<HostSettings>& hosts,
                                                            std::chrono::seconds timeout, SignalWatch& signals,
                                                            bool* interrupted);

}  // namespace troupe
