// Recording: a recorded run in a file. Its ticks are read from its begin, or from any keyframe.
//
// Opening reads the index and the chunks with edits, from which follow the spans of ticks: a position (the number of a
// state) is found without reading the ticks before it. Ticks are named by positions, because edits repeat ticks or set
// them back.
//
// A file that is cut off or damaged is read up to its last whole chunk. Any bytes are safe: each message is checked by
// its converter, and TickAssembler checks that the messages make ticks and that none is missing. A Recording is
// constant but for SetTail; a TickReader is for one thread, and any number of them may read one recording.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "recording/mcap/reader.h"
#include "recording/recorded_run.h"
#include "recording/timeline/timeline.h"
#include "transport/protocol/messages.h"
#include "troupe/ids.h"
#include "troupe/result.h"

namespace troupe {

// True for the paths of recordings, which end in ".mcap".
bool IsRecordingPath(const std::string& path);

class Recording {
 public:
  enum class Ticks : bool { kAtLeastOne, kPerhapsNone };
  // The error is a file that is no recording, or one that is damaged before its first tick.
  static Result<Recording> Open(const std::string& path, Ticks ticks = Ticks::kAtLeastOne);
  static Result<Recording> Open(std::unique_ptr<const mcap::ByteSource> source, Ticks ticks = Ticks::kAtLeastOne);

  const std::string& name() const { return file_.name(); }
  std::uint64_t size() const { return file_.size(); }  // bytes
  const RecordedRun& run() const { return run_; }
  // The ticks that follow the ticks of the chunks, without log times: of a journal (recording/journal.h), else none.
  const std::vector<RecordedTick>& tail() const { return tail_; }
  void SetTail(std::vector<RecordedTick> tail) { tail_ = std::move(tail); }
  // The states in the chunks, as their index and their edits tell: states in a damaged chunk count. Not empty.
  const TimeSpans& spans() const { return spans_; }
  // The log time of the last state in the chunks, ns.
  std::uint64_t end_time() const;
  // The interval of the ticks since the newest edit in the chunks.
  std::int64_t interval_ns() const { return static_cast<std::int64_t>(clocks_.back().interval_ns); }
  // Why the file is not read to its end; nothing if it is. A damage within a chunk is found when the chunk is read.
  const std::optional<mcap::Damage>& damage() const { return file_.damage(); }
  // Compares the whole file with its CRC.
  Status CheckData() const { return file_.CheckData(); }

  // The chunks with ticks; a keyframe is in the first tick of its chunk.
  std::size_t chunks() const { return file_.chunks().size() - 1; }
  std::size_t keyframes() const { return keyframe_chunks_.size(); }
  static constexpr std::uint64_t kEnd = std::numeric_limits<std::uint64_t>::max();  // a position behind all states
  // The last chunk that begins with a keyframe at a state of at most this position; chunk 0 if there is none.
  std::size_t KeyframeUpTo(std::uint64_t position) const;
  // Calls `visit` with each edit in the chunks before `chunk`, in their order, and the number of the state to which it
  // led. The error is a damaged chunk, or that of `visit`.
  using EditVisitor = std::function<Status(std::uint64_t number, const RecordedEdit&)>;
  Status VisitEdits(std::size_t chunk, const EditVisitor& visit) const;

 private:
  friend class TickReader;

  // The log times of a span.
  struct SpanClock {
    std::uint64_t begin = 0;        // ns
    std::uint64_t interval_ns = 1;  // of its ticks
  };

  Recording(mcap::Reader file, RecordedRun run, std::array<std::optional<std::uint16_t>, kRecordingChannels> ids)
      : file_(std::move(file)), run_(std::move(run)), ids_(ids) {}
  // Chunk 0 of the file has the run.
  Result<mcap::Chunk> ReadChunk(std::size_t chunk) const { return file_.ReadChunk(chunk + 1); }
  std::optional<RecordingChannel> ChannelOf(const mcap::Message& message) const;
  bool Has(const mcap::ChunkInfo& chunk, RecordingChannel channel) const;
  // Finds the keyframes, the edits, and with them the spans.
  void FindPlaces();
  Status FindEdits(std::size_t chunk, std::vector<TimeSpan>& spans);
  // At least the log time of the state at a position.
  std::uint64_t LogTimeOf(std::uint64_t position) const;
  Error ErrorIn(std::size_t chunk, const std::string& problem) const;

  mcap::Reader file_;
  RecordedRun run_;
  std::array<std::optional<std::uint16_t>, kRecordingChannels> ids_;
  std::vector<RecordedTick> tail_;
  TimeSpans spans_;
  std::vector<SpanClock> clocks_;             // by span
  std::vector<std::size_t> keyframe_chunks_;  // ascending
  std::vector<std::size_t> edit_chunks_;      // that have edits, ascending
};

// The messages of one tick of a recorded run: their order, and the tick that they make.

struct TickMessage {
  RecordingChannel channel = RecordingChannel::kTicks;
  std::vector<std::byte> data;  // CDR
};

// In the order in which a recording has them: the last is that of kTicks.
std::vector<TickMessage> MessagesOf(const RecordedTick& tick, RunId run);

// Makes ticks of messages that follow each other, and checks that none is missing.
class TickAssembler {
 public:
  // `first_number`: of the first tick; nothing: any.
  explicit TickAssembler(std::optional<std::uint64_t> first_number) : expected_(first_number) {}

  // Clears the tick, whose memory is reused, for the next messages.
  void Begin(RecordedTick& tick);
  // True if the message was the last of the tick, which then lacks its log time.
  Result<bool> Add(RecordingChannel channel, std::span<const std::byte> data, RecordedTick& tick);
  // The number of the tick that follows; nothing: any.
  const std::optional<std::uint64_t>& expected() const { return expected_; }

 private:
  Status AddProposals(std::span<const std::byte> data, RecordedTick& tick);
  Status Check(const RecordedTick& tick) const;

  std::optional<std::uint64_t> expected_;
  bool has_proposals_ = false;
  ProposalMessage proposals_;
};

// TickReader: the ticks of a recording, one after another.
class TickReader {
 public:
  // Begins at a chunk. The recording outlives the reader.
  explicit TickReader(const Recording& recording, std::size_t chunk = 0)
      : recording_(&recording),
        next_chunk_(chunk),
        assembler_(chunk == 0 ? std::optional<std::uint64_t>(0) : std::nullopt) {}

  // Reads the next tick, of a chunk or of the tail; false at the end. The error is damage: of a chunk, or a missing
  // tick. `tick`: valid after true; its memory is reused.
  Result<bool> Next(RecordedTick& tick);

 private:
  Result<bool> NextChunk();
  bool NextOfTail(RecordedTick& tick);
  Error Broken(const std::string& problem) const;

  const Recording* recording_;
  std::size_t next_chunk_;
  std::optional<mcap::Chunk> chunk_;
  std::size_t next_message_ = 0;
  TickAssembler assembler_;
  std::uint64_t log_time_ = 0;  // of the last tick of a chunk
  std::size_t next_in_tail_ = 0;
};

}  // namespace troupe
