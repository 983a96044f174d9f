// LinePipe: a pipe that children write lines into and this process reads without waiting.
#pragma once

#include <string>
#include <vector>

namespace troupe {

class LinePipe {
 public:
  LinePipe();
  ~LinePipe();
  LinePipe(const LinePipe&) = delete;
  LinePipe& operator=(const LinePipe&) = delete;

  int reading_end() const { return reading_end_; }
  // For children. Closed in this process by CloseWritingEnd, so that the pipe ends with the last child.
  int writing_end() const { return writing_end_; }
  void CloseWritingEnd();

  // The lines that are complete by now; at the pipe's end also what is left.
  std::vector<std::string> Read();
  bool at_end() const { return at_end_; }

 private:
  int reading_end_ = -1;
  int writing_end_ = -1;
  bool at_end_ = false;
  std::string partial_;
};

}  // namespace troupe
