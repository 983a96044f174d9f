// Journal: a recording that a service writes such that another one can continue the run: the recording, and its tail.
//
// A recording is compressed in chunks, which are written seconds apart; a run that is to survive the death of its
// service needs every tick at once. So the tail has each tick uncompressed, in a record of its own with a length and a
// CRC, until the recording has it in a whole chunk. After a crash, the whole chunks and the tail's records behind them
// are the run, without a gap.
//
// Two files take turns, so that none of them grows: a file is emptied only when the recording has all of its ticks. A
// record that was being written at the crash is damaged, and ends the reading of its file.
//
// One writer: the recording's file is locked (mcap/byte_stream.h). Readers need no lock: they read again when a file
// was emptied under them. Append is on the way of every tick; with JournalSync::kYes it waits for the disk.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/base/file.h"
#include "recording/mcap/byte_stream.h"
#include "recording/recorded_run.h"
#include "recording/recording.h"
#include "transport/protocol/messages.h"
#include "transport/protocol/run_progress.h"
#include "troupe/result.h"

namespace troupe {

struct JournalFiles {
  std::string recording;
  std::array<std::string, 2> tail;

  // With the tail beside the recording.
  static JournalFiles Of(const std::string& recording);
};

enum class JournalSync : bool {
  kNo,   // ticks survive the end of the process
  kYes,  // and a loss of power
};

// JournalTail: the newest ticks of a run, which its recording does not have yet, in two files beside the recording.
// Each tick is written by one call before the run continues, so that it survives the process.
//
// The files take turns: one of them is emptied and used again once the recording has all of its ticks.
class JournalTail {
 public:
  // The files, emptied. Errors name the file; errors of Append have the code kOutputFailed.
  static Result<std::unique_ptr<JournalTail>> Create(const JournalFiles& files, RunId run, JournalSync sync);
  // The files as they are: new records follow their newest one.
  static Result<std::unique_ptr<JournalTail>> Continue(const JournalFiles& files, RunId run, JournalSync sync);
  JournalTail(const JournalTail&) = delete;
  JournalTail& operator=(const JournalTail&) = delete;

  // Writes the tick, if not null, and the progress of the run after it. After an error nothing more is written.
  Status Append(const RecordedTick* tick, const RunProgress& progress);
  // The number of the first tick that the recording lacks. On any thread.
  void Release(std::uint64_t first_unwritten) { released_.store(first_unwritten, std::memory_order_relaxed); }
  // Removes the files: the recording is whole.
  void Remove();
  // Empties the files: no run can be continued from them.
  void Discard();

 private:
  struct Segment {
    std::string path;
    FileDescriptor file{-1};
    std::uint64_t size = 0;
    std::optional<std::uint64_t> last_number;  // of its ticks
  };

  JournalTail(RunId run, JournalSync sync) : run_(run), sync_(sync) {}
  Status OpenFiles(const JournalFiles& files);
  Status Write(Segment& segment);

  const RunId run_;
  const JournalSync sync_;
  std::array<Segment, 2> segments_;
  std::size_t current_ = 0;
  std::uint64_t next_serial_ = 0;
  std::atomic<std::uint64_t> released_ = 0;  // by Release
  std::vector<std::byte> record_;
  Status status_;
};

// The content of the files.
struct JournalTailContent {
  std::vector<RecordedTick> ticks;      // each follows the previous one; without log times
  std::optional<RunProgress> progress;  // the newest
  std::uint64_t next_serial = 0;
  std::size_t newest_segment = 0;
  std::array<std::uint64_t, 2> sizes = {};                        // bytes of the records
  std::array<std::optional<std::uint64_t>, 2> last_numbers = {};  // of the ticks in each file
};

// Reads the records of the run with ticks from `first_number` on. Stops at the first damaged record of each file, as
// one that was being written. Files that do not exist are empty; the error is one that cannot be read.
Result<JournalTailContent> ReadJournalTail(const JournalFiles& files, RunId run, std::uint64_t first_number);

// A journal that this process continues. The files are locked for other processes.
struct Journal {
  Recording recording;                   // its whole chunks, perhaps none, and the ticks after these as its tail
  RunProgress progress;                  // the newest
  mcap::WrittenPart written;             // of the recording
  std::unique_ptr<mcap::ByteSink> sink;  // appends to it

  // Cuts the recording behind its last whole chunk. Nothing if it ends before the description of its run: the run had
  // not begun. The error is a file that another process writes, or one that is not readable.
  static Result<std::optional<Journal>> OpenToContinue(const JournalFiles& files);
};

// The run in a journal that another process may be writing, as far as it has come. It has its damage() until its file
// is finished. The error is also one that has no run yet.
Result<Recording> ReadJournal(const JournalFiles& files);

}  // namespace troupe
