// Progress: shows the progress of a run on standard error: a status line on a terminal, otherwise a line every five
// seconds.
#pragma once

#include <chrono>
#include <string>

#include "transport/protocol/messages.h"

namespace troupe {

// "tick 312/600, 31.2 s, 12.3 x real time, 100 robots, waiting for r3, r4 (1.2 s)"
std::string StatusText(const StatusMessage& status);

class Progress {
 public:
  Progress();
  ~Progress();  // removes the status line
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void Update(const StatusMessage& status);
  // Prints an event, by its name (troupe/event.h). Omits stalls and the joins before the first tick, which are
  // too many.
  void TellEvent(Tick tick, const std::string& event, const std::string& text);
  // Prints a permanent line.
  void Tell(const std::string& line);

 private:
  void ClearStatusLine();

  bool terminal_;
  std::string status_line_;  // shown now, terminal only
  bool has_lost_agent_ = false;
  std::chrono::steady_clock::time_point next_line_;
};

}  // namespace troupe
