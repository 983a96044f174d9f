#include "world-service/observers/recorder/run_recorder.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <exception>
#include <utility>

#include "common/base/version.h"
#include "recording/tick_reader.h"
#include "world-service/core/step_version.h"

namespace troupe {
namespace {

using Clock = std::chrono::steady_clock;

// A run that is killed loses no more than the ticks of about this time.
constexpr std::chrono::duration<double> kLongestDelay(1.0);

// The frame without state and events.
FrameMessage HeadOf(const FrameMessage& frame) {
  FrameMessage head;
  head.run = frame.run;
  head.state.tick = frame.state.tick;
  head.state_hash = frame.state_hash;
  head.edition = frame.edition;
  head.world_edition = frame.world_edition;
  head.fresh_edition = frame.fresh_edition;
  return head;
}

}  // namespace

Result<std::unique_ptr<RunRecorder>> RunRecorder::Create(const std::string& path, const RecordingOptions& options) {
  Result<std::unique_ptr<mcap::ByteSink>> sink = mcap::CreateFileSink(path);
  if (!sink.ok()) return sink.error();
  return std::make_unique<RunRecorder>(std::move(sink).value(), options);
}

Result<std::unique_ptr<RunRecorder>> RunRecorder::Continue(Journal journal, const ResumedRun& resumed,
                                                           const RecordingOptions& options) {
  RecordingOptions continued = options;
  continued.keyframe_interval = journal.recording.run().keyframe_interval;
  auto recorder = std::make_unique<RunRecorder>(nullptr, continued);
  Result<std::unique_ptr<JournalTail>> tail = JournalTail::Continue(*options.journal, resumed.run, options.sync);
  if (!tail.ok()) return tail.error();
  recorder->tail_ = std::move(tail).value();
  RunProgress progress = resumed.progress;
  progress.incarnation = resumed.incarnation;
  if (Status failure = recorder->tail_->Append(nullptr, progress); !failure.ok()) return failure.error();
  recorder->writer_.emplace(RecordingWriter::Continue(std::move(journal.sink), std::move(journal.written), resumed.run,
                                                      journal.recording.places().interval_ns(),
                                                      journal.recording.places().end()));
  if (resumed.frame) {
    recorder->last_ = HeadOf(*resumed.frame);
    recorder->next_number_ = resumed.next_number;
  }
  for (RecordedTick& tick : journal.tail) recorder->Push(std::move(tick));
  return recorder;
}

RunRecorder::RunRecorder(std::unique_ptr<mcap::ByteSink> sink, const RecordingOptions& options)
    : options_(options), sink_(std::move(sink)), queue_(options.queue_bytes) {}

RunRecorder::~RunRecorder() {
  queue_.Close();
  if (thread_.joinable()) thread_.join();
}

Status RunRecorder::OnBegin(const RunStart& start) {
  if (writer_) {
    StartWriting();
    return {};
  }
  RecordedRun run;
  run.run = start.run;
  run.program_version = VersionText();
  run.step_version = kStepVersion;
  run.file = options_.world_file;
  run.keyframe_interval = options_.keyframe_interval;
  run.settings = start.settings;
  run.world = options_.begin ? options_.begin->source->run().world : start.scene->world();
  Result<RecordingWriter> writer = RecordingWriter::Create(std::move(sink_), run);
  if (!writer.ok()) return writer.error();
  writer_.emplace(std::move(writer).value());
  if (options_.journal) {
    Result<std::unique_ptr<JournalTail>> tail = JournalTail::Create(*options_.journal, run.run, options_.sync);
    if (!tail.ok()) return tail.error();
    tail_ = std::move(tail).value();
  }
  if (options_.begin) {
    if (Status failure = WriteBegin(*options_.begin); !failure.ok()) return failure;
  }
  StartWriting();
  return {};
}

Status RunRecorder::WriteBegin(const RecordedBegin& begin) {
  TickReader reader(*begin.source);
  RecordedTick tick;
  while (next_number_ <= begin.last_number) {
    const Result<bool> more = reader.Next(tick);
    if (!more.ok()) return more.error();
    if (!more.value()) return Error{{begin.source->name()}, "a tick is missing", ErrorCode::kFailure};
    if (Status failure = writer_->Add(tick); !failure.ok()) return failure;
    next_number_ = tick.number + 1;
  }
  if (begin.change) {
    if (Status failure = writer_->Add(*begin.change); !failure.ok()) return failure;
    next_number_ = begin.change->number + 1;
  }
  return writer_->EndChunk();
}

void RunRecorder::StartWriting() {
  if (thread_.joinable()) return;
  thread_ = std::thread([this] {
    try {
      Write();
    } catch (const std::exception& exception) {
      Fail(FailureOf(exception));
    }
  });
}

Status RunRecorder::OnCommit(const CommittedTick& tick, const RunProgress& progress) {
  if (tail_ == nullptr) return {};
  if (tick.is_recorded) return OnProgress(progress);
  if (failed_) return Reported(status());
  progress_ = progress;
  RecordedTick recorded = Convert(tick);
  if (Status failure = tail_->Append(&recorded, progress); !failure.ok()) return Reported(failure);
  Push(std::move(recorded));
  return {};
}

Status RunRecorder::OnProgress(const RunProgress& progress) {
  if (tail_ == nullptr) return {};
  progress_ = progress;
  const Status written = tail_->Append(nullptr, progress);
  return written.ok() ? written : Reported(written);
}

Status RunRecorder::Reported(const Status& failure) {
  if (!options_.journal_is_optional) return failure;
  if (!failed_) Fail(failure.error());
  if (!std::exchange(dropped_, true)) {
    fmt::print(stderr,
               "the journal of the run cannot be written ({}): the run cannot be continued if its world service "
               "dies\n",
               failure.error().message);
    tail_->Discard();
  }
  return {};
}

Status RunRecorder::OnTick(const CommittedTick& tick) {
  if (dropped_) return {};
  if (failed_) return Reported(status());
  if (tick.is_recorded) {
    last_ = HeadOf(tick.frame);
  } else if (tail_ == nullptr) {
    Push(Convert(tick));
  }
  return {};
}

Status RunRecorder::Append(RecordedTick tick) {
  while (!failed_ && !queue_.has_room()) {
    if (Status failure = Flush(); !failure.ok()) return failure;
  }
  if (failed_) return status();
  tick.number = next_number_++;
  if (tick.edit || !IsKeyframe(tick.tick)) tick.keyframe.reset();
  if (tail_ != nullptr && !dropped_) {
    if (Status failure = tail_->Append(&tick, progress_); !failure.ok()) return failure;
  }
  Push(std::move(tick));
  return {};
}

RecordedTick RunRecorder::Convert(const CommittedTick& tick) {
  const FrameMessage& frame = tick.frame;
  RecordedTick recorded = queue_.Reuse();
  recorded.number = next_number_++;
  recorded.tick = frame.state.tick;
  recorded.edition = frame.edition;
  recorded.state_hash = frame.state_hash;
  recorded.proposals.assign(tick.proposals.begin(), tick.proposals.end());
  recorded.commands.assign(tick.commands.begin(), tick.commands.end());
  recorded.events = frame.events;
  if (tick.edit != nullptr) {
    RecordedEdit& edit = recorded.edit.emplace();
    edit.before = last_;
    edit.before.state = *tick.before;
    edit.request = tick.edit->request;
    if (tick.edit->world != nullptr) edit.world = *tick.edit->world;
  } else if (IsKeyframe(frame.state.tick) || frame.last) {
    recorded.keyframe = HeadOf(frame);
    recorded.keyframe->state = frame.state;
  }
  last_ = HeadOf(frame);
  return recorded;
}

bool RunRecorder::IsReady() {
  return failed_ || queue_.has_room();  // the next tick reports the failure
}

void RunRecorder::Push(RecordedTick tick) {
  queue_.Push(std::move(tick));
  ++pushed_;
}

Status RunRecorder::Flush() {
  const std::uint64_t ticks = pushed_;
  std::unique_lock lock(mutex_);
  flush_asked_ = std::max(flush_asked_, ticks);
  queue_.Interrupt();
  flush_changed_.wait(lock, [&] { return flushed_ >= ticks || !status_.ok(); });
  return status_;
}

bool RunRecorder::MustFlush(std::uint64_t written) const {
  const std::lock_guard lock(mutex_);
  return flushed_ < flush_asked_ && written >= flush_asked_;
}

void RunRecorder::NoteFlushed(std::uint64_t written) {
  const std::lock_guard lock(mutex_);
  flushed_ = written;
  flush_changed_.notify_all();
}

void RunRecorder::Write() {
  Clock::time_point ended = Clock::now();  // the newest chunk that was ended for its age
  std::uint64_t written_ticks = 0;
  while (!queue_.done()) {
    std::optional<RecordedTick> tick = queue_.Pop(kLongestDelay.count());
    Status written = tick ? writer_->Add(*tick) : Status();
    if (tick) ++written_ticks;
    const Clock::time_point now = Clock::now();
    if (written.ok() && (now - ended >= kLongestDelay || MustFlush(written_ticks))) {
      written = writer_->EndChunk();
      ended = now;
      if (written.ok()) NoteFlushed(written_ticks);
    }
    if (!written.ok()) return Fail(written.error());
    if (Status released = ReleaseTail(); !released.ok()) return Fail(released.error());
    if (tick) queue_.Recycle(std::move(*tick));
  }
  if (Status closed = writer_->Close(); !closed.ok()) return Fail(closed.error());
  NoteFlushed(written_ticks);
  if (tail_ != nullptr) tail_->Remove();
}

Status RunRecorder::ReleaseTail() {
  if (tail_ == nullptr || writer_->first_unwritten() == released_) return {};
  released_ = writer_->first_unwritten();
  if (options_.sync == JournalSync::kYes) {
    if (Status failure = writer_->Sync(); !failure.ok()) return failure;
  }
  tail_->Release(released_);
  return {};
}

void RunRecorder::Fail(Error error) {
  const std::lock_guard lock(mutex_);
  if (status_.ok()) status_ = std::move(error);
  failed_ = true;
  flush_changed_.notify_all();
}

Status RunRecorder::status() const {
  const std::lock_guard lock(mutex_);
  return status_;
}

Status RunRecorder::OnEnd() {
  queue_.Close();
  if (thread_.joinable()) thread_.join();
  const Status outcome = status();
  return outcome.ok() ? outcome : Reported(outcome);
}

}  // namespace troupe
