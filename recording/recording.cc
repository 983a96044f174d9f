#include "recording/recording.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <utility>

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

// REQUIRES: all channels were found.
Result<std::array<std::optional<LayoutChange>, kRecordingChannels>> FindLayouts(const mcap::Reader& file,
                                                                                const ChannelIds& ids) {
  std::array<std::optional<LayoutChange>, kRecordingChannels> layouts;
  for (std::size_t i = 0; i < kRecordingChannels; ++i) {
    const mcap::Schema& schema = file.schemas().at(file.channels().at(*ids[i]).schema);
    const mcap::Schema today = SchemaOf(kChannelTypes[i]);
    if (LayoutChange::IsNone(schema.data, today.data)) continue;
    Result<LayoutChange> change = LayoutChange::Between(schema.data, today.data, kChannelTypes[i].type);
    if (!change.ok()) return change.error();
    layouts[i] = std::move(change).value();
  }
  return layouts;
}

// The bytes of a message in the layout of today: itself, or in `changed`.
Result<std::span<const std::byte>> InLayoutOfToday(const std::optional<LayoutChange>& layout,
                                                   std::span<const std::byte> data, std::vector<std::byte>& changed) {
  if (!layout) return data;
  Result<std::vector<std::byte>> applied = layout->Apply(data);
  if (!applied.ok()) return applied.error();
  changed = std::move(applied).value();
  return std::span<const std::byte>(changed);
}

std::uint64_t EndTime(const mcap::Reader& file) {
  std::uint64_t end = 0;
  for (const mcap::ChunkInfo& chunk : file.chunks()) end = std::max(end, chunk.end_time);
  return end;
}

}  // namespace

bool IsRecordingPath(const std::string& path) {
  return path.ends_with(".mcap");
}

Recording::Recording(mcap::Reader file, RecordedRun run, ChannelIds ids, Layouts layouts)
    : file_(std::move(file)),
      run_(std::move(run)),
      ids_(ids),
      layouts_(std::move(layouts)),
      places_(run_.world.interval_ns, EndTime(file_)) {}

Result<mcap::Chunk> Recording::ReadChunk(std::size_t chunk) const {
  Result<mcap::Chunk> read = file_.ReadChunk(chunk + 1);
  if (!read.ok() || std::all_of(layouts_.begin(), layouts_.end(), [](const auto& layout) { return !layout; })) {
    return read;
  }
  std::vector<std::vector<std::byte>> changed(read.value().messages.size());
  std::size_t size = 0;
  for (std::size_t i = 0; i < changed.size(); ++i) {
    mcap::Message& message = read.value().messages[i];
    const std::optional<RecordingChannel> channel = ChannelOf(message);
    if (!channel) continue;
    const Result<std::span<const std::byte>> data =
        InLayoutOfToday(layouts_[static_cast<std::size_t>(*channel)], message.data, changed[i]);
    if (!data.ok()) return data.error();
    message.data = data.value();
  }
  for (const mcap::Message& message : read.value().messages) size += message.data.size();
  std::vector<std::byte> records;
  records.reserve(size);
  for (mcap::Message& message : read.value().messages) {
    const std::size_t begin = records.size();
    records.insert(records.end(), message.data.begin(), message.data.end());
    message.data = std::span<const std::byte>(records).subspan(begin);
  }
  read.value().records = std::move(records);
  return read;
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
  Result<Layouts> layouts = FindLayouts(file, ids);
  if (!layouts.ok()) return Error{{file.name()}, layouts.error().message};
  std::vector<std::byte> changed;
  const Result<std::span<const std::byte>> first = InLayoutOfToday(
      layouts.value()[static_cast<std::size_t>(RecordingChannel::kRun)], messages.front().data, changed);
  if (!first.ok()) return Error{{file.name()}, first.error().message};
  Result<RecordedRun> run = RunFromBytes(first.value());
  if (!run.ok()) return Error{{file.name()}, run.error().message};
  Recording recording(std::move(file), std::move(run).value(), ids, std::move(layouts).value());
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

void Recording::FindPlaces() {
  for (std::size_t i = 0; i < chunks(); ++i) {
    const mcap::ChunkInfo& chunk = file_.chunks()[i + 1];
    if (Has(chunk, RecordingChannel::kKeyframes)) keyframe_chunks_.push_back(i);
    if (!Has(chunk, RecordingChannel::kEdits)) continue;
    // Damage of a chunk that is found here is found again when the ticks are read.
    if (!FindEdits(i).ok()) return;
    edit_chunks_.push_back(i);
  }
}

Status Recording::FindEdits(std::size_t chunk) {
  const Result<mcap::Chunk> content = ReadChunk(chunk);
  if (!content.ok()) return content.error();
  std::optional<std::int64_t> interval_ns;  // of an edit whose tick follows
  std::int64_t current_ns = places_.interval_ns();
  for (const mcap::Message& message : content.value().messages) {
    const std::optional<RecordingChannel> channel = ChannelOf(message);
    if (channel == RecordingChannel::kEdits) {
      const Result<RecordedEdit> edit = EditFromBytes(message.data);
      if (!edit.ok()) return edit.error();
      if (ReplacesWorld(edit.value().request.command) && edit.value().world) {
        current_ns = edit.value().world->interval_ns;
      }
      interval_ns = current_ns;
    } else if (channel == RecordingChannel::kTicks && interval_ns) {
      RecordedTick tick;
      if (Status broken = TickFromBytes(message.data, tick); !broken.ok()) return broken;
      places_.AddEdit(message.log_time, tick.tick, *interval_ns);
      interval_ns.reset();
    }
  }
  return {};
}

std::optional<std::size_t> Recording::KeyframeBefore(std::uint64_t log_time) const {
  std::optional<std::size_t> found;
  for (const std::size_t chunk : keyframe_chunks_) {
    if (file_.chunks()[chunk + 1].start_time > log_time) break;
    found = chunk;
  }
  return found;
}

std::size_t Recording::KeyframeUpTo(Edition edition, Tick tick) const {
  const auto is_up_to = [&](std::size_t chunk) {
    RecordedTick first;
    const Result<bool> read = TickReader(*this, chunk).Next(first);
    return read.ok() && read.value() && std::pair(first.edition, first.tick) <= std::pair(edition, tick);
  };
  const auto end = std::partition_point(keyframe_chunks_.begin(), keyframe_chunks_.end(), is_up_to);
  return end == keyframe_chunks_.begin() ? 0 : *std::prev(end);
}

Status Recording::VisitEdits(std::size_t chunk, const EditVisitor& visit) const {
  for (const std::size_t with_edits : edit_chunks_) {
    if (with_edits >= chunk) break;
    const Result<mcap::Chunk> content = ReadChunk(with_edits);
    if (!content.ok()) return content.error();
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

TickPlaces::TickPlaces(std::int64_t interval_ns, std::uint64_t end) : end_(end) {
  AddEdit(0, 0, interval_ns);
}

void TickPlaces::AddEdit(std::uint64_t log_time, Tick tick, std::int64_t interval_ns) {
  parts_.push_back({log_time, tick, static_cast<std::uint64_t>(std::max<std::int64_t>(1, interval_ns))});
}

std::uint64_t TickPlaces::EndOf(std::size_t part) const {
  const std::uint64_t end = part + 1 < parts_.size() ? parts_[part + 1].begin : end_;
  return std::max(end, parts_[part].begin);
}

Tick TickPlaces::LastTickOf(std::size_t part) const {
  return parts_[part].tick + (EndOf(part) - parts_[part].begin) / parts_[part].interval_ns;
}

std::optional<std::uint64_t> TickPlaces::Find(std::size_t part, Tick tick) const {
  if (tick < parts_[part].tick || tick > LastTickOf(part)) return std::nullopt;
  return parts_[part].begin + (tick - parts_[part].tick) * parts_[part].interval_ns;
}

std::optional<std::uint64_t> TickPlaces::First(Tick tick) const {
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    if (const auto found = Find(i, tick)) return found;
  }
  return std::nullopt;
}

std::optional<std::uint64_t> TickPlaces::Last(Tick tick) const {
  for (std::size_t i = parts_.size(); i-- > 0;) {
    if (const auto found = Find(i, tick)) return found;
  }
  return std::nullopt;
}

Tick TickPlaces::greatest() const {
  Tick greatest = 0;
  for (std::size_t i = 0; i < parts_.size(); ++i) greatest = std::max(greatest, LastTickOf(i));
  return greatest;
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

Result<bool> TickReader::Next(RecordedTick& tick) {
  assembler_.Begin(tick);
  bool begun = false;
  for (;;) {
    if (!chunk_ || next_message_ == chunk_->messages.size()) {
      if (begun) return Broken("found a chunk that ends within a tick");
      Result<bool> more = NextChunk();
      if (!more.ok() || !more.value()) return more;
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
