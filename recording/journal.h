// Journal: a recording that a service writes such that another one can continue the run: the recording, and its tail
// (journal_tail.h).
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "recording/journal_tail.h"
#include "recording/mcap/byte_sink.h"
#include "recording/recording.h"
#include "recording/tick_reader.h"
#include "transport/protocol/run_progress.h"
#include "troupe/result.h"

namespace troupe {

// A journal that this process continues. The files are locked for other processes.
struct Journal {
  Recording recording;                   // its whole chunks; it may have none
  std::vector<RecordedTick> tail;        // the ticks after these
  RunProgress progress;                  // the newest
  mcap::WrittenPart written;             // of the recording
  std::unique_ptr<mcap::ByteSink> sink;  // appends to it

  // Cuts the recording behind its last whole chunk. Nothing if it ends before the description of its run: the run had
  // not begun. The error is a file that another process writes, or one that is not readable.
  static Result<std::optional<Journal>> OpenToContinue(const JournalFiles& files);
};

// The ticks of a journal, one after another.
class JournalReader {
 public:
  // Begins at a chunk of the recording. The journal outlives the reader.
  explicit JournalReader(const Journal& journal, std::size_t chunk = 0)
      : journal_(journal), reader_(journal.recording, chunk) {}

  // As TickReader::Next; ticks of the tail have the log time 0.
  Result<bool> Next(RecordedTick& tick);

 private:
  const Journal& journal_;
  TickReader reader_;
  std::size_t next_in_tail_ = 0;
};

}  // namespace troupe
