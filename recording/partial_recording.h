// PartialRecording: a run in a file, as far as it has come: a recording, or a journal that another process may be
// writing.
#pragma once

#include <cstddef>
#include <vector>

#include "recording/journal.h"
#include "recording/recording.h"
#include "troupe/result.h"

namespace troupe {

struct PartialRecording {
  Recording recording;             // its whole chunks; a journal may have none yet
  std::vector<RecordedTick> tail;  // the ticks after these; empty for a recording
  bool is_whole = true;            // the run has ended, and its file was finished

  // Of a journal. The error is also one that has no run yet.
  static Result<PartialRecording> Read(const JournalFiles& files);
};

// Its ticks, one after another.
class RunReader {
 public:
  // Begins at a chunk of the recording. The run outlives the reader.
  explicit RunReader(const PartialRecording& run, std::size_t chunk = 0)
      : tail_(run.tail), reader_(run.recording, chunk) {}

  // As TickReader::Next; ticks of the tail have the log time 0.
  Result<bool> Next(RecordedTick& tick);

 private:
  const std::vector<RecordedTick>& tail_;
  TickReader reader_;
  std::size_t next_in_tail_ = 0;
};

}  // namespace troupe
