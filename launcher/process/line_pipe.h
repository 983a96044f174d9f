// LineReader and LinePipe: lines from pipes, read without waiting.
#pragma once

#include <string>
#include <vector>

namespace troupe {

class LineReader {
 public:
  // Makes the descriptor non-blocking. Does not own it.
  explicit LineReader(int descriptor);

  // The lines completed since the last call; at the end of the input, or if it cannot be read any more, also an
  // unfinished one.
  std::vector<std::string> Read();
  bool at_end() const { return at_end_; }

 private:
  int descriptor_;
  bool at_end_ = false;
  std::string partial_;
};

// A pipe that children write lines into and this process reads.
class LinePipe {
 public:
  // Throws std::system_error without resources.
  LinePipe();
  ~LinePipe();
  LinePipe(const LinePipe&) = delete;
  LinePipe& operator=(const LinePipe&) = delete;

  int reading_end() const { return ends_.reading; }
  // For children. Closed in this process by CloseWritingEnd, so that the pipe ends with the last child.
  int writing_end() const { return ends_.writing; }
  void CloseWritingEnd();

  std::vector<std::string> Read() { return reader_.Read(); }
  bool at_end() const { return reader_.at_end(); }

 private:
  struct Ends {
    Ends();
    int reading = -1;
    int writing = -1;
  };

  Ends ends_;
  LineReader reader_;
};

}  // namespace troupe
