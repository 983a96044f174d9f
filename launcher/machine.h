// Machine: where processes of a run are started; this one, or another one over a connection.
#pragma once

#include <sys/types.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "launcher/process.h"

namespace troupe {

// A process of the run on some machine.
class Child {
 public:
  virtual ~Child() = default;
  virtual pid_t pid() const = 0;  // there; 0: not known
  virtual const std::optional<ProcessEnd>& end() const = 0;
  // Looks whether it has ended, without waiting. True once: when it is found to have ended.
  virtual bool Poll() = 0;
  // Nothing if it has ended.
  virtual void Signal(int signal) = 0;
  // It has ended, or will without further help.
  virtual void Kill() = 0;

  bool running() const { return !end(); }
};

class Machine {
 public:
  virtual ~Machine() = default;

  virtual const std::string& name() const = 0;  // empty: the machine of the launcher
  // The folder for output of processes there; empty: they may write where the user wants it.
  virtual const std::string& folder() const = 0;
  virtual std::string ProgramPath(const std::string& program) const = 0;
  // `reports`: it writes reports for the launcher (docs/tick-protocol.md).
  virtual Result<std::unique_ptr<Child>> Start(const std::string& program, const std::vector<std::string>& arguments,
                                               bool reports) = 0;

  // Readable when there is something new.
  virtual std::vector<int> descriptors() const = 0;
  // Lines since the last call: what processes said to people, and what they reported.
  virtual std::vector<std::string> TakeOutput() = 0;
  virtual std::vector<std::string> TakeReports() = 0;
  // Once, when the connection is lost: why.
  virtual Status TakeLoss() { return std::nullopt; }
  // Copies a file from there to here.
  virtual Status Fetch(const std::string& from, const std::string& to) = 0;
};

}  // namespace troupe
