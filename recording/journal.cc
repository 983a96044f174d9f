#include "recording/journal.h"

#include <filesystem>
#include <system_error>
#include <utility>

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
  return std::optional(Journal{std::move(recording).value(), std::move(tail.ticks),
                               tail.progress.value_or(RunProgress()), std::move(written).value(),
                               std::move(sink).value()});
}

Result<bool> JournalReader::Next(RecordedTick& tick) {
  Result<bool> more = reader_.Next(tick);
  if (!more.ok() || more.value()) return more;
  if (next_in_tail_ == journal_.tail.size()) return false;
  tick = journal_.tail[next_in_tail_++];
  return true;
}

}  // namespace troupe
