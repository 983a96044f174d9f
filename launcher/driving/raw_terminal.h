// RawTerminal: a terminal whose keys arrive at once and are not shown, until the object is destroyed or the process
// ends by a signal that can be handled. Ctrl-C still sends SIGINT.
#pragma once

#include <termios.h>

#include <memory>

#include "troupe/result.h"

namespace troupe {

class RawTerminal {
 public:
  // The error: `descriptor` is no terminal. One at a time in a process.
  static Result<std::unique_ptr<RawTerminal>> Open(int descriptor);
  ~RawTerminal();
  RawTerminal(const RawTerminal&) = delete;
  RawTerminal& operator=(const RawTerminal&) = delete;

 private:
  RawTerminal(int descriptor, const termios& before);

  int descriptor_;
  termios before_;
};

}  // namespace troupe
