// Progress: tells a person how a run goes, on standard error: one line that is kept up to date on a terminal, a line
// now and then otherwise.
#pragma once

#include <chrono>
#include <string>

#include "common/protocol/messages.h"

namespace troupe {

// "tick 312/600, 31.2 s, 12.3 x real time, 100 robots, waiting for r3, r4 (1.2 s)"
std::string StatusText(const StatusMessage& status);

class Progress {
 public:
  Progress();
  ~Progress();  // takes the status line away
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void Update(const StatusMessage& status);
  // An event of the run by its name (common/model/event.h). Stalls are too many to tell, and so are the robots that
  // come at the start.
  void TellEvent(Tick tick, const std::string& event, const std::string& text);
  // A line that stays.
  void Tell(const std::string& line);

 private:
  void ClearStatusLine();

  bool terminal_;
  std::string status_line_;  // shown now, terminal only
  std::chrono::steady_clock::time_point next_line_;
};

}  // namespace troupe
