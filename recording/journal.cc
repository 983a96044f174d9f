#include "recording/journal.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <limits>
#include <map>
#include <system_error>
#include <utility>

#include "common/base/bytes.h"
#include "common/base/system_error.h"
#include "recording/mcap/bytes.h"

namespace troupe {
namespace {

// The number of the tick after the last of a recording.
Result<std::uint64_t> NextNumber(const Recording& recording) {
  if (recording.chunks() == 0) return 0;
  TickReader reader(recording, recording.chunks() - 1);
  RecordedTick tick;
  std::uint64_t next = 0;
  for (;;) {
    const Result<bool> more = reader.Next(tick);
    if (!more.ok()) return more.error();
    if (!more.value()) return next;
    next = tick.number + 1;
  }
}

// A file is left for the other one when it is longer.
constexpr std::uint64_t kSegmentSize = std::uint64_t{1} << 20;  // bytes
constexpr std::uint64_t kNoPause = std::numeric_limits<std::uint64_t>::max();
constexpr double kNoSpeed = 0.0;
constexpr int kReadAttempts = 3;                                // to read a journal that is being written
constexpr std::size_t kRecordHead = 2 * sizeof(std::uint32_t);  // length and CRC of the content

void AddRobots(ByteWriter<>& out, const std::vector<RobotId>& robots) {
  out.WriteWithLength<std::uint32_t>([&] {
    for (const RobotId robot : robots) out.Write(static_cast<std::uint32_t>(robot.index()));
  });
}

std::vector<RobotId> ReadRobots(ByteReader& in) {
  std::vector<RobotId> robots;
  ByteReader ids(in.ReadWithLength<std::uint32_t>());
  while (ids.ok() && !ids.at_end()) robots.emplace_back(ids.Read<std::uint32_t>());
  return robots;
}

// The commands and inputs in the form of a recorded tick, then the remaining ticks of each command.
void AddCommands(ByteWriter<>& out, const std::vector<CommandInForce>& commands, const std::vector<Input>& inputs) {
  out.Write(static_cast<std::uint32_t>(commands.size()));
  out.Write(static_cast<std::uint32_t>(inputs.size()));
  if (commands.empty() && inputs.empty()) return;
  RecordedTick tick;
  tick.inputs = inputs;
  for (const CommandInForce& in_force : commands) tick.commands.push_back(in_force.command);
  // In the form of a tick of a recording, whose converters check it.
  out.WriteWithLength<std::uint32_t>([&] { out.WriteBytes(TickToBytes(tick)); });
  for (const CommandInForce& in_force : commands) {
    out.Write(in_force.ticks);
    out.Write(static_cast<std::uint8_t>(in_force.sent));
  }
}

// False: they are damaged.
bool ReadCommands(ByteReader& in, std::vector<CommandInForce>& commands, std::vector<Input>& inputs) {
  const auto count = in.Read<std::uint32_t>();
  const auto input_count = in.Read<std::uint32_t>();
  if (!in.ok() || (count == 0 && input_count == 0)) return in.ok();
  RecordedTick tick;
  if (!TickFromBytes(in.ReadWithLength<std::uint32_t>(), tick).ok() || tick.commands.size() != count ||
      tick.inputs.size() != input_count) {
    return false;
  }
  inputs = std::move(tick.inputs);
  for (RobotCommand& command : tick.commands) {
    const auto ticks = in.Read<std::uint64_t>();
    commands.push_back({std::move(command), ticks, in.Read<std::uint8_t>() != 0});
  }
  return in.ok();
}

void AddProgress(ByteWriter<>& out, const RunProgress& progress) {
  // All members: a new one does not compile without a place here, and one in ReadProgress.
  const auto& [incarnation, ticks_to_pause, absent, newcomers, stalls, rejected, frozen, speed_is_set, speed, commands,
               inputs, first_number, is_rewinding] = progress;
  out.Write(incarnation);
  out.Write(ticks_to_pause.value_or(kNoPause));
  out.Write(stalls);
  out.Write(rejected);
  AddRobots(out, absent);
  AddRobots(out, newcomers);
  out.Write(static_cast<std::uint32_t>(frozen.size()));
  for (const std::string& name : frozen) out.WriteText(name);
  out.Write(static_cast<std::uint8_t>(speed_is_set));
  out.Write(speed.value_or(kNoSpeed));
  AddCommands(out, commands, inputs);
  out.Write(first_number);
  out.Write(static_cast<std::uint8_t>(is_rewinding));
}

// False: it is damaged.
bool ReadProgress(ByteReader& in, RunProgress& progress) {
  progress.incarnation = in.Read<Incarnation>();
  const auto ticks = in.Read<std::uint64_t>();
  if (ticks != kNoPause) progress.ticks_to_pause = ticks;
  progress.stalls = in.Read<std::uint64_t>();
  progress.rejected = in.Read<std::uint64_t>();
  progress.absent = ReadRobots(in);
  progress.newcomers = ReadRobots(in);
  for (auto left = in.Read<std::uint32_t>(); left > 0 && in.ok(); --left) progress.frozen.insert(in.ReadText());
  progress.speed_is_set = in.Read<std::uint8_t>() != 0;
  const auto speed = in.Read<double>();
  if (speed > kNoSpeed) progress.speed = speed;
  if (!ReadCommands(in, progress.commands, progress.inputs)) return false;
  progress.first_number = in.Read<std::uint64_t>();
  progress.is_rewinding = in.Read<std::uint8_t>() != 0;
  return in.ok();
}

struct TailRecord {
  RunProgress progress;
  std::optional<RecordedTick> tick;
};

// Nothing for a damaged record, or one of another run.
std::optional<TailRecord> ParseRecord(std::span<const std::byte> content, RunId run, std::uint64_t& serial) {
  ByteReader in(content);
  // A record of an earlier run that used the same files.
  if (in.Read<RunId>() != run) return std::nullopt;
  serial = in.Read<std::uint64_t>();
  TailRecord record;
  if (!ReadProgress(in, record.progress)) return std::nullopt;
  if (in.at_end()) return record;
  TickAssembler assembler(std::nullopt);
  RecordedTick& tick = record.tick.emplace();
  assembler.Begin(tick);
  while (!in.at_end()) {
    const auto channel = in.Read<std::uint8_t>();
    const std::span<const std::byte> data = in.ReadWithLength<std::uint32_t>();
    if (!in.ok() || channel >= kRecordingChannels) return std::nullopt;
    const Result<bool> done = assembler.Add(static_cast<RecordingChannel>(channel), data, tick);
    if (!done.ok()) return std::nullopt;
    if (done.value()) return record;
  }
  return std::nullopt;
}

// More than the tail of any run.
constexpr std::size_t kMaxTailBytes = std::numeric_limits<std::size_t>::max() / 2;

// Empty if there is no file.
Result<std::string> ReadFile(const std::string& path) {
  std::error_code unknown;
  if (!std::filesystem::exists(path, unknown) && !unknown) return std::string();
  Result<std::string> bytes = ReadWholeFile(path, kMaxTailBytes);
  if (bytes.ok()) return bytes;
  return Error{{path}, "cannot read: " + bytes.error().message, ErrorCode::kFailure};
}

}  // namespace

Result<std::optional<Journal>> Journal::OpenToContinue(const JournalFiles& files) {
  std::error_code failure;
  const bool exists = std::filesystem::exists(files.recording, failure);
  if (!failure && (!exists || std::filesystem::file_size(files.recording, failure) == 0) && !failure) {
    return std::optional<Journal>();
  }
  Result<std::unique_ptr<const mcap::ByteSource>> source = mcap::OpenFileSource(files.recording);
  if (!source.ok()) return source.error();
  const Result<mcap::Reader> file = mcap::Reader::Open(std::move(source).value());
  if (!file.ok()) return file.error();
  Result<mcap::WrittenPart> written = file.value().ReadWrittenPart();
  if (!written.ok()) return written.error();
  if (written.value().chunks.empty()) return std::optional<Journal>();
  Result<std::unique_ptr<mcap::ByteSink>> sink = mcap::AppendFileSink(files.recording, written.value().size);
  if (!sink.ok()) return sink.error();
  Result<Recording> recording = Recording::Open(files.recording, Recording::Ticks::kPerhapsNone);
  if (!recording.ok()) return recording.error();
  const Result<std::uint64_t> next = NextNumber(recording.value());
  if (!next.ok()) return next.error();
  Result<JournalTailContent> read = ReadJournalTail(files, recording.value().run().run, next.value());
  if (!read.ok()) return read.error();
  JournalTailContent& tail = read.value();
  // Ticks that the chunks have, too, are left out (ReadJournalTail).
  recording.value().SetTail(std::move(tail.ticks));
  return std::optional(Journal{std::move(recording).value(), tail.progress.value_or(RunProgress()),
                               std::move(written).value(), std::move(sink).value()});
}

// The writer may empty a file of the tail between the two readings: then the recording has more ticks than it had.
Result<Recording> ReadJournal(const JournalFiles& files) {
  for (int attempt = 0;; ++attempt) {
    Result<Recording> recording = Recording::Open(files.recording, Recording::Ticks::kPerhapsNone);
    if (!recording.ok()) return recording.error();
    const Result<std::uint64_t> next = NextNumber(recording.value());
    if (!next.ok()) return next.error();
    Result<JournalTailContent> tail = ReadJournalTail(files, recording.value().run().run, next.value());
    if (!tail.ok()) return tail.error();
    const auto& last = tail.value().last_numbers;
    const bool is_behind = tail.value().ticks.empty() && std::max(last[0], last[1]) >= next.value();
    if (is_behind && attempt < kReadAttempts) continue;
    recording.value().SetTail(std::move(tail.value().ticks));
    return recording;
  }
}

JournalFiles JournalFiles::Of(const std::string& recording) {
  return {recording, {recording + ".journal-a", recording + ".journal-b"}};
}

Result<JournalTailContent> ReadJournalTail(const JournalFiles& files, RunId run, std::uint64_t first_number) {
  JournalTailContent content;
  std::map<std::uint64_t, TailRecord> records;  // by serial
  const std::array<std::string, 2>& paths = files.tail;
  for (std::size_t i = 0; i < paths.size(); ++i) {
    const Result<std::string> read = ReadFile(paths[i]);
    if (!read.ok()) return read.error();
    const std::span<const std::byte> bytes = std::as_bytes(std::span(read.value()));
    ByteReader in(bytes);
    while (in.remaining() > kRecordHead) {
      const auto length = in.Read<std::uint32_t>();
      const auto crc = in.Read<std::uint32_t>();
      const std::span<const std::byte> record = in.ReadBytes(length);
      std::uint64_t serial = 0;
      if (!in.ok() || mcap::Crc32(record) != crc) break;
      std::optional<TailRecord> parsed = ParseRecord(record, run, serial);
      if (!parsed) break;
      content.sizes[i] = bytes.size() - in.remaining();
      if (parsed->tick) content.last_numbers[i] = parsed->tick->number;
      if (serial >= content.next_serial) {
        content.next_serial = serial + 1;
        content.newest_segment = i;
      }
      // By serial: the files are read one after the other, and their records may interleave.
      records[serial] = std::move(*parsed);
    }
  }
  for (auto& [serial, record] : records) {
    content.progress = std::move(record.progress);
    if (!record.tick || record.tick->number != first_number + content.ticks.size()) continue;
    content.ticks.push_back(std::move(*record.tick));
  }
  return content;
}

Status JournalTail::OpenFiles(const JournalFiles& files) {
  const std::array<std::string, 2>& paths = files.tail;
  for (std::size_t i = 0; i < paths.size(); ++i) {
    segments_[i].path = paths[i];
    Result<FileDescriptor> file = OpenToWrite(paths[i]);
    if (!file.ok()) return Error{{paths[i]}, "cannot open for writing: " + file.error().message, file.error().code};
    segments_[i].file = std::move(file).value();
  }
  return {};
}

Result<std::unique_ptr<JournalTail>> JournalTail::Create(const JournalFiles& files, RunId run, JournalSync sync) {
  std::unique_ptr<JournalTail> tail(new JournalTail(run, sync));
  if (Status failure = tail->OpenFiles(files); !failure.ok()) return failure.error();
  for (const Segment& segment : tail->segments_) {
    if (ftruncate(segment.file.get(), 0) != 0) return SystemError("cannot write", segment.path, ErrorCode::kFailure);
  }
  return tail;
}

Result<std::unique_ptr<JournalTail>> JournalTail::Continue(const JournalFiles& files, RunId run, JournalSync sync) {
  std::unique_ptr<JournalTail> tail(new JournalTail(run, sync));
  if (Status failure = tail->OpenFiles(files); !failure.ok()) return failure.error();
  const Result<JournalTailContent> read = ReadJournalTail(files, run, 0);
  if (!read.ok()) return read.error();
  const JournalTailContent& content = read.value();
  tail->next_serial_ = content.next_serial;
  tail->current_ = content.newest_segment;
  for (std::size_t i = 0; i < tail->segments_.size(); ++i) {
    tail->segments_[i].size = content.sizes[i];
    tail->segments_[i].last_number = content.last_numbers[i];
  }
  return tail;
}

Status JournalTail::Append(const RecordedTick* tick, const RunProgress& progress) {
  if (!status_.ok()) return status_;
  record_.clear();
  ByteWriter out(record_);
  out.Write(std::uint32_t{0});  // the length and the CRC follow below
  out.Write(std::uint32_t{0});
  out.Write(run_);
  out.Write(next_serial_++);
  AddProgress(out, progress);
  if (tick != nullptr) {
    for (const TickMessage& message : MessagesOf(*tick, run_)) {
      out.Write(static_cast<std::uint8_t>(message.channel));
      out.WriteWithLength<std::uint32_t>([&] { out.WriteBytes(message.data); });
    }
  }
  // The CRC is of the content: a torn write of any part is found.
  const auto content = std::span<const std::byte>(record_).subspan(kRecordHead);
  const std::array<std::uint32_t, 2> head = {static_cast<std::uint32_t>(content.size()), mcap::Crc32(content)};
  std::memcpy(record_.data(), head.data(), kRecordHead);

  Segment& other = segments_[1 - current_];
  // Both conditions: a file that is still needed is written on, beyond its usual size, when the recording lags.
  if (segments_[current_].size > kSegmentSize &&
      (!other.last_number || *other.last_number < released_.load(std::memory_order_relaxed))) {
    current_ = 1 - current_;
    other.size = 0;
    other.last_number.reset();
    if (ftruncate(other.file.get(), 0) != 0)
      return status_ = SystemError("cannot write", other.path, ErrorCode::kOutputFailed);
  }
  Segment& segment = segments_[current_];
  if (tick != nullptr) segment.last_number = tick->number;
  return Write(segment);
}

Status JournalTail::Write(Segment& segment) {
  std::span<const std::byte> bytes = record_;
  while (!bytes.empty()) {
    const ssize_t written = pwrite(segment.file.get(), bytes.data(), bytes.size(), static_cast<off_t>(segment.size));
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return status_ = SystemError("cannot write", segment.path, ErrorCode::kOutputFailed);
    segment.size += static_cast<std::uint64_t>(written);
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  if (sync_ == JournalSync::kYes && fdatasync(segment.file.get()) != 0) {
    return status_ = SystemError("cannot write", segment.path, ErrorCode::kOutputFailed);
  }
  return {};
}

void JournalTail::Discard() {
  for (const Segment& segment : segments_) static_cast<void>(ftruncate(segment.file.get(), 0));
}

void JournalTail::Remove() {
  for (const Segment& segment : segments_) unlink(segment.path.c_str());
}

}  // namespace troupe
