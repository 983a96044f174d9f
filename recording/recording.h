// Recording: a recorded run in a file. Its ticks are read from its begin, or from any keyframe (tick_reader.h).
//
// A file that is cut off or damaged is read up to its last whole chunk. Any bytes are safe.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "recording/channels.h"
#include "recording/mcap/reader.h"
#include "recording/recorded_run.h"
#include "recording/tick_places.h"
#include "troupe/result.h"

namespace troupe {

// True for the paths of recordings: those that end in ".mcap".
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
  const TickPlaces& places() const { return places_; }
  // Why the file is not read to its end; nothing if it is. A damage within a chunk is found when the chunk is read.
  const std::optional<mcap::Damage>& damage() const { return file_.damage(); }
  // Compares the whole file with its CRC.
  Status CheckData() const { return file_.CheckData(); }

  // The chunks with ticks; a keyframe is in the first tick of its chunk.
  std::size_t chunks() const { return file_.chunks().size() - 1; }
  std::size_t keyframes() const { return keyframe_chunks_.size(); }
  // The last chunk that begins with a keyframe at a log time of at most `log_time`; nothing if there is none.
  std::optional<std::size_t> KeyframeBefore(std::uint64_t log_time) const;
  // The last chunk that begins with a keyframe of at most this edition and tick; chunk 0 if there is none.
  std::size_t KeyframeUpTo(Edition edition, Tick tick) const;
  // Calls `visit` with each edit in the chunks before `chunk`, in their order, and the number of the state to which it
  // led. The error is a damaged chunk, or that of `visit`.
  using EditVisitor = std::function<Status(std::uint64_t number, const RecordedEdit&)>;
  Status VisitEdits(std::size_t chunk, const EditVisitor& visit) const;

 private:
  friend class TickReader;

  Recording(mcap::Reader file, RecordedRun run, std::array<std::optional<std::uint16_t>, kRecordingChannels> ids);
  // Chunk 0 of the file has the run.
  Result<mcap::Chunk> ReadChunk(std::size_t chunk) const { return file_.ReadChunk(chunk + 1); }
  std::optional<RecordingChannel> ChannelOf(const mcap::Message& message) const;
  bool Has(const mcap::ChunkInfo& chunk, RecordingChannel channel) const;
  // Finds the keyframes and the edits.
  void FindPlaces();
  Status FindEdits(std::size_t chunk);
  Error ErrorIn(std::size_t chunk, const std::string& problem) const;

  mcap::Reader file_;
  RecordedRun run_;
  std::array<std::optional<std::uint16_t>, kRecordingChannels> ids_;
  TickPlaces places_;
  std::vector<std::size_t> keyframe_chunks_;  // ascending
  std::vector<std::size_t> edit_chunks_;      // that have edits, ascending
};

}  // namespace troupe
