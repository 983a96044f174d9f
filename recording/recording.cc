// Reading a recording by states, not by messages. A position counts states from the first one on; log times lead from a
// position to the chunk that has it, because the summary of an MCAP file has times only. An edit may change the length
// of a tick or go back in simulated time, hence the spans and the clocks: within a span positions and log times are
// linear.
//
// Only chunks with edits are read when a file is opened; all others are read when their ticks are asked for.
#include "recording/recording.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <sstream>
#include <utility>

#include "common/base/identity.h"
#include "common/base/text.h"
#include "transport/wire/message_bytes.h"

namespace troupe {
namespace {

using ChannelIds = std::array<std::optional<std::uint16_t>, kRecordingChannels>;

// Channels of other topics and types are ignored.
ChannelIds FindChannels(const mcap::Reader& file) {
  ChannelIds ids;
  for (const auto& [id, channel] : file.channels()) {
    const auto schema = file.schemas().find(channel.schema);
    if (schema == file.schemas().end() || channel.message_encoding != "cdr") continue;
    for (std::size_t i = 0; i < kRecordingChannels; ++i) {
      if (channel.topic == kChannelTypes[i].topic && schema->second.name == kChannelTypes[i].type) ids[i] = id;
    }
  }
  return ids;
}

std::uint64_t IntervalOf(const WorldDescription& world) {
  return static_cast<std::uint64_t>(std::max<std::int64_t>(1, world.interval_ns));
}

// The words of a schema: two that differ in their comments at most have the same.
// The schema in the file is the text of the IDL file of its writer. Comments of another version do not matter, fields
// do: messages are read by position, without names.
std::string WordsOf(const std::string& schema) {
  std::string words;
  std::istringstream lines(schema);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream in(line.substr(0, line.find("//")));
    for (std::string word; in >> word;) words += word + ' ';
  }
  return words;
}

// REQUIRES: all channels were found.
Status CheckLayouts(const mcap::Reader& file, const ChannelIds& ids) {
  for (std::size_t i = 0; i < kRecordingChannels; ++i) {
    const std::string& found = file.schemas().at(file.channels().at(*ids[i]).schema).data;
    const std::string expected = SchemaOf(kChannelTypes[i]).data;
    if (found == expected || WordsOf(found) == WordsOf(expected)) continue;
    return Error{{file.name()},
                 fmt::format("found a recording whose messages of {} have other fields, expected those of troupe {}",
                             kChannelTypes[i].topic, VersionText())};
  }
  return {};
}

}  // namespace

bool IsRecordingPath(const std::string& path) {
  return path.ends_with(".mcap");
}

Result<Recording> Recording::Open(const std::string& path, Ticks ticks) {
  Result<std::unique_ptr<const mcap::ByteSource>> source = mcap::OpenFileSource(path);
  if (!source.ok()) return source.error();
  return Open(std::move(source).value(), ticks);
}

Result<Recording> Recording::Open(std::unique_ptr<const mcap::ByteSource> source, Ticks ticks) {
  Result<mcap::Reader> opened = mcap::Reader::Open(std::move(source));
  if (!opened.ok()) return opened.error();
  mcap::Reader& file = opened.value();
  if (file.profile() != kRecordingProfile) {
    return Error{
        {file.name()},
        fmt::format("found an MCAP file of profile {:?}, expected a recording of Troupe", CutUtf8(file.profile(), 40))};
  }
  // The first chunk has the run alone.
  if (file.chunks().size() < (ticks == Ticks::kAtLeastOne ? 2 : 1)) {
    return Error{
        {file.name()},
        "the recording ends before its first tick" + (file.damage() ? ": " + file.damage()->problem : std::string()),
        ErrorCode::kFailure};
  }
  const ChannelIds ids = FindChannels(file);
  if (std::find(ids.begin(), ids.end(), std::nullopt) != ids.end()) {
    return Error{{file.name()}, "found a recording without the channels of Troupe"};
  }
  const Result<mcap::Chunk> chunk = file.ReadChunk(0);
  if (!chunk.ok()) return chunk.error();
  const std::vector<mcap::Message>& messages = chunk.value().messages;
  if (messages.size() != 1 || messages.front().channel != ids[static_cast<std::size_t>(RecordingChannel::kRun)]) {
    return Error{{file.name()}, "found a recording that does not begin with its run"};
  }
  if (Status other = CheckLayouts(file, ids); !other.ok()) return other.error();
  Result<RecordedRun> run = RunFromBytes(messages.front().data);
  if (!run.ok()) return Error{{file.name()}, run.error().message};
  Recording recording(std::move(file), std::move(run).value(), ids);
  recording.FindPlaces();
  return recording;
}

Error Recording::ErrorIn(std::size_t chunk, const std::string& problem) const {
  return {{name()}, fmt::format("byte {}: {}", file_.chunks()[chunk + 1].offset, problem), ErrorCode::kFailure};
}

std::optional<RecordingChannel> Recording::ChannelOf(const mcap::Message& message) const {
  const auto found = std::find(ids_.begin(), ids_.end(), message.channel);
  if (found == ids_.end()) return std::nullopt;
  return static_cast<RecordingChannel>(found - ids_.begin());
}

bool Recording::Has(const mcap::ChunkInfo& chunk, RecordingChannel channel) const {
  return std::binary_search(chunk.channels.begin(), chunk.channels.end(), *ids_[static_cast<std::size_t>(channel)]);
}

std::uint64_t Recording::end_time() const {
  std::uint64_t end = 0;
  for (const mcap::ChunkInfo& chunk : file_.chunks()) end = std::max(end, chunk.end_time);
  return end;
}

void Recording::FindPlaces() {
  std::vector<TimeSpan> spans = {TimeSpan()};
  clocks_ = {{0, IntervalOf(run_.world)}};
  for (std::size_t i = 0; i < chunks(); ++i) {
    const mcap::ChunkInfo& chunk = file_.chunks()[i + 1];
    if (Has(chunk, RecordingChannel::kKeyframes)) keyframe_chunks_.push_back(i);
    if (!Has(chunk, RecordingChannel::kEdits)) continue;
    // Damage of a chunk that is found here is found again when the ticks are read.
    if (!FindEdits(i, spans).ok()) break;
    edit_chunks_.push_back(i);
  }
  for (std::size_t i = 0; i + 1 < spans.size(); ++i) spans[i].last = spans[i + 1].first - 1;
  TimeSpan& newest = spans.back();
  const std::uint64_t end = std::max(end_time(), clocks_.back().begin);
  const std::uint64_t states_behind = (end - clocks_.back().begin) / clocks_.back().interval_ns;
  // From the log time: the chunks behind the last edit have not been read.
  newest.last = newest.first + std::min(states_behind, std::numeric_limits<std::uint64_t>::max() - newest.first);
  spans_ = TimeSpans(std::move(spans));
}

Status Recording::FindEdits(std::size_t chunk, std::vector<TimeSpan>& spans) {
  const Result<mcap::Chunk> content = ReadChunk(chunk);
  if (!content.ok()) return content.error();
  std::optional<std::uint64_t> interval_ns;  // behind an edit whose tick follows
  for (const mcap::Message& message : content.value().messages) {
    const std::optional<RecordingChannel> channel = ChannelOf(message);
    if (channel == RecordingChannel::kEdits) {
      const Result<RecordedEdit> edit = EditFromBytes(message.data);
      if (!edit.ok()) return edit.error();
      const bool replaces = ReplacesWorld(edit.value().request) && edit.value().world;
      interval_ns = replaces ? IntervalOf(*edit.value().world) : clocks_.back().interval_ns;
    } else if (channel == RecordingChannel::kTicks && interval_ns) {
      RecordedTick tick;
      if (Status broken = TickFromBytes(message.data, tick); !broken.ok()) return broken;
      if (tick.number <= spans.back().first) return ErrorIn(chunk, "found states that do not follow each other");
      spans.push_back({tick.number, tick.number, tick.tick, tick.edition});
      clocks_.push_back({message.log_time, *interval_ns});
      interval_ns.reset();
    }
  }
  return {};
}

std::uint64_t Recording::LogTimeOf(std::uint64_t position) const {
  const std::vector<TimeSpan>& spans = spans_.all();
  if (position > spans.back().last) return std::numeric_limits<std::uint64_t>::max();
  const auto after =
      std::partition_point(spans.begin(), spans.end(), [&](const TimeSpan& span) { return span.first <= position; });
  const auto span = static_cast<std::size_t>(after - spans.begin()) - 1;
  return clocks_[span].begin + (position - spans[span].first) * clocks_[span].interval_ns;
}

std::size_t Recording::KeyframeUpTo(std::uint64_t position) const {
  const std::uint64_t log_time = LogTimeOf(position);
  // Backwards: the newest keyframe not behind the position leaves the fewest states to step.
  for (std::size_t i = keyframe_chunks_.size(); i-- > 0;) {
    const std::size_t chunk = keyframe_chunks_[i];
    if (file_.chunks()[chunk + 1].start_time > log_time) continue;
    // Edits take no time: the keyframe may follow the position.
    RecordedTick first;
    // The number of the keyframe's state is in its tick.
    const Result<bool> read = TickReader(*this, chunk).Next(first);
    if (read.ok() && read.value() && first.keyframe && first.number <= position) return chunk;
  }
  return 0;
}

Status Recording::VisitEdits(std::size_t chunk, const EditVisitor& visit) const {
  for (const std::size_t with_edits : edit_chunks_) {
    if (with_edits >= chunk) break;
    const Result<mcap::Chunk> content = ReadChunk(with_edits);
    if (!content.ok()) return content.error();
    // Messages of a tick are in the order of MessagesOf: an edit comes before its tick.
    std::optional<RecordedEdit> edit;  // whose tick follows
    for (const mcap::Message& message : content.value().messages) {
      const std::optional<RecordingChannel> channel = ChannelOf(message);
      if (channel == RecordingChannel::kEdits) {
        Result<RecordedEdit> read = EditFromBytes(message.data);
        if (!read.ok()) return ErrorIn(with_edits, read.error().message);
        edit = std::move(read).value();
      } else if (channel == RecordingChannel::kTicks && edit) {
        RecordedTick tick;
        if (Status broken = TickFromBytes(message.data, tick); !broken.ok()) {
          return ErrorIn(with_edits, broken.error().message);
        }
        if (Status failure = visit(tick.number, *std::exchange(edit, std::nullopt)); !failure.ok()) return failure;
      }
    }
  }
  return {};
}

std::vector<TickMessage> MessagesOf(const RecordedTick& tick, RunId run) {
  std::vector<TickMessage> messages;
  if (tick.is_step()) {
    ProposalMessage message;
    message.run = run;
    message.tick = tick.tick;
    message.edition = tick.edition;
    message.proposals = tick.proposals;
    messages.push_back({RecordingChannel::kProposals, wire::ToBytes(message)});
  }
  if (tick.edit) messages.push_back({RecordingChannel::kEdits, EditToBytes(*tick.edit)});
  if (tick.keyframe) messages.push_back({RecordingChannel::kKeyframes, wire::ToBytes(*tick.keyframe)});
  messages.push_back({RecordingChannel::kTicks, TickToBytes(tick)});
  return messages;
}

void TickAssembler::Begin(RecordedTick& tick) {
  tick.edit.reset();
  tick.keyframe.reset();
  tick.proposals.clear();
  has_proposals_ = false;
}

Result<bool> TickAssembler::Add(RecordingChannel channel, std::span<const std::byte> data, RecordedTick& tick) {
  switch (channel) {
    case RecordingChannel::kRun:
      return Error{{}, "found a second start of the run"};
    case RecordingChannel::kProposals: {
      if (Status broken = AddProposals(data, tick); !broken.ok()) return broken.error();
      return false;
    }
    case RecordingChannel::kEdits: {
      Result<RecordedEdit> edit = EditFromBytes(data);
      if (!edit.ok()) return edit.error();
      if (tick.edit) return Error{{}, "found two edits of one tick"};
      tick.edit = std::move(edit).value();
      return false;
    }
    case RecordingChannel::kKeyframes: {
      Result<FrameMessage> keyframe = wire::FromBytes<FrameMessage>(data);
      if (!keyframe.ok()) return keyframe.error();
      if (tick.keyframe) return Error{{}, "found two keyframes of one tick"};
      tick.keyframe = std::move(keyframe).value();
      return false;
    }
    case RecordingChannel::kTicks:
      break;
  }
  if (Status broken = TickFromBytes(data, tick); !broken.ok()) return broken.error();
  if (Status broken = Check(tick); !broken.ok()) return broken.error();
  expected_ = tick.number + 1;
  return true;
}

Status TickAssembler::AddProposals(std::span<const std::byte> data, RecordedTick& tick) {
  Result<ProposalMessage> proposals = wire::FromBytes<ProposalMessage>(data);
  if (!proposals.ok()) return proposals.error();
  if (has_proposals_) return Error{{}, "found the proposals of one tick twice"};
  has_proposals_ = true;
  proposals_ = std::move(proposals).value();
  tick.proposals = std::move(proposals_.proposals);
  return {};
}

Status TickAssembler::Check(const RecordedTick& tick) const {
  const auto broken = [&](const std::string& problem) {
    return Error{{}, fmt::format("tick {}: {}", tick.tick, problem)};
  };
  if (expected_ && tick.number != *expected_) {
    return broken(fmt::format("found state number {}, expected {}: states are missing", tick.number, *expected_));
  }
  if (tick.is_step() != has_proposals_) {
    return broken(has_proposals_ ? "found proposals, expected none" : "found neither proposals nor an edit");
  }
  if (tick.number == 0 && tick.edit) return broken("found an edit before the first state");
  if (has_proposals_ && (proposals_.tick != tick.tick || proposals_.edition != tick.edition)) {
    return broken(fmt::format("found proposals of tick {}", proposals_.tick));
  }
  if (tick.keyframe && (tick.keyframe->state.tick != tick.tick || tick.keyframe->edition != tick.edition ||
                        tick.keyframe->state_hash != tick.state_hash)) {
    return broken(fmt::format("found a keyframe of tick {}", tick.keyframe->state.tick));
  }
  return {};
}

Error TickReader::Broken(const std::string& problem) const {
  return recording_->ErrorIn(next_chunk_ - 1, problem);
}

Result<bool> TickReader::NextChunk() {
  chunk_.reset();
  next_message_ = 0;
  if (next_chunk_ >= recording_->chunks()) return false;
  Result<mcap::Chunk> chunk = recording_->ReadChunk(next_chunk_++);
  if (!chunk.ok()) return chunk.error();
  chunk_ = std::move(chunk).value();
  return true;
}

bool TickReader::NextOfTail(RecordedTick& tick) {
  if (next_in_tail_ == recording_->tail().size()) return false;
  tick = recording_->tail()[next_in_tail_++];
  return true;
}

Result<bool> TickReader::Next(RecordedTick& tick) {
  assembler_.Begin(tick);
  bool begun = false;
  for (;;) {
    if (!chunk_ || next_message_ == chunk_->messages.size()) {
      if (begun) return Broken("found a chunk that ends within a tick");
      Result<bool> more = NextChunk();
      if (!more.ok()) return more;
      if (!more.value()) return NextOfTail(tick);
      continue;
    }
    const mcap::Message& message = chunk_->messages[next_message_++];
    begun = true;
    const std::optional<RecordingChannel> channel = recording_->ChannelOf(message);
    if (!channel) continue;
    const Result<bool> done = assembler_.Add(*channel, message.data, tick);
    if (!done.ok()) return Broken(done.error().message);
    if (!done.value()) continue;
    if (message.log_time < log_time_) {
      return Broken(fmt::format("tick {}: found a log time that decreases", tick.tick));
    }
    tick.log_time = log_time_ = message.log_time;
    return true;
  }
}

}  // namespace troupe
