#include "world-service/observers/recorder/run_recorder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <utility>

#include "common/base/identity.h"
#include "common/base/or_failure.h"
#include "common/base/print.h"
#include "world-service/core/step.h"

namespace troupe {
namespace {

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

// The progress of a run that is being rewound.
RunProgress WithinRewind(RunProgress progress) {
  progress.is_rewinding = true;
  progress.commands.clear();
  progress.inputs.clear();
  return progress;
}

using Clock = std::chrono::steady_clock;

// A run that is killed loses no more than the ticks of about this time.
constexpr std::chrono::duration<double> kMaxDelay(1.0);
constexpr std::size_t kMaxSpare = 64;

// Nearly all of a world is its shapes.
std::size_t SizeOf(const WorldDescription& world) {
  std::size_t size = world.models.size() * sizeof(ModelDescription) + world.robots.size() * sizeof(RobotDescription);
  for (const Shape& shape : world.shapes) size += sizeof shape + shape.rectangles.size() * sizeof(Rectangle);
  return size;
}

std::size_t SizeOf(const RecordedTick& tick) {
  std::size_t size = sizeof tick + tick.proposals.size() * sizeof(Proposal) + tick.events.size() * sizeof(Event);
  for (const Proposal& proposal : tick.proposals) {
    size += proposal.joint_velocities.size() * sizeof(double);
    for (const RadioMessage& message : proposal.messages) size += sizeof message + message.bytes.size();
  }
  size += tick.commands.size() * sizeof(RobotCommand) + tick.inputs.size() * sizeof(Input);
  if (tick.keyframe) size += MemoryOf(tick.keyframe->state);
  if (!tick.edit) return size;
  size += sizeof(RecordedEdit) + MemoryOf(tick.edit->before.state);
  if (tick.edit->world) size += SizeOf(*tick.edit->world);
  return size;
}

}  // namespace

Result<std::unique_ptr<RunRecorder>> RunRecorder::Create(const std::string& path, const RecordingOptions& options) {
  Result<std::unique_ptr<mcap::ByteSink>> sink = mcap::CreateFileSink(path);
  if (!sink.ok()) return sink.error();
  return std::make_unique<RunRecorder>(std::move(sink).value(), options, path);
}

Result<std::unique_ptr<RunRecorder>> RunRecorder::Continue(Journal journal, const ResumedRun& resumed,
                                                           const RecordingOptions& options) {
  RecordingOptions continued = options;
  continued.keyframe_interval = journal.recording.run().keyframe_interval;
  auto recorder = std::make_unique<RunRecorder>(nullptr, continued, options.journal->recording);
  Committed& committed = recorder->committed_;
  Result<std::unique_ptr<JournalTail>> tail = JournalTail::Continue(*options.journal, resumed.run, options.sync);
  if (!tail.ok()) return tail.error();
  committed.tail = std::move(tail).value();
  committed.progress = resumed.progress;
  committed.progress.incarnation = resumed.incarnation;
  if (Status failure = committed.tail->Append(nullptr, committed.progress); !failure.ok()) return failure.error();
  if (resumed.frame) {
    committed.newest = HeadOf(*resumed.frame);
    committed.next_number = resumed.next_number;
  }
  recorder->MakeThread(RecordingWriter::Continue(std::move(journal.sink), std::move(journal.written), resumed.run,
                                                 journal.recording.interval_ns(), journal.recording.end_time()));
  for (const RecordedTick& tick : journal.recording.tail()) recorder->thread_->Push(tick);
  return recorder;
}

RunRecorder::RunRecorder(std::unique_ptr<mcap::ByteSink> sink, const RecordingOptions& options, std::string path)
    : options_(options), path_(std::move(path)), sink_(std::move(sink)) {}

void RunRecorder::MakeThread(RecordingWriter writer) {
  RecordingThread::Options options{.queue_bytes = options_.queue_bytes, .sync = options_.sync == JournalSync::kYes};
  if (JournalTail* const tail = committed_.tail.get()) {
    // The tail need not have the ticks that the recording has.
    options.on_written = [tail](std::uint64_t first_unwritten) { tail->Release(first_unwritten); };
    options.on_closed = [tail] { tail->Remove(); };
  }
  thread_.emplace(std::move(writer), std::move(options));
}

Status RunRecorder::OnBegin(const RunStart& start) {
  if (!thread_) {
    RecordedRun run;
    run.run = start.run;
    run.program_version = VersionText();
    run.step_version = kStepVersion;
    run.file = options_.world_file;
    run.keyframe_interval = options_.keyframe_interval;
    run.settings = start.settings;
    const RecordedRun* const before = options_.begin ? &options_.begin->source->run() : nullptr;
    run.world = before != nullptr ? before->world : start.scene->world();
    run.expectations = before != nullptr ? before->expectations : options_.expectations;
    run.regions = before != nullptr ? before->regions : options_.regions;
    Result<RecordingWriter> writer = RecordingWriter::Create(std::move(sink_), run);
    if (!writer.ok()) return writer.error();
    if (options_.journal) {
      Result<std::unique_ptr<JournalTail>> tail = JournalTail::Create(*options_.journal, run.run, options_.sync);
      if (!tail.ok()) return tail.error();
      committed_.tail = std::move(tail).value();
    }
    if (options_.begin) {
      if (Status failure = WriteStart(*options_.begin, writer.value()); !failure.ok()) return failure;
    }
    MakeThread(std::move(writer).value());
  }
  StartWriting();
  return {};
}

Status RunRecorder::WriteStart(const RecordedStart& begin, RecordingWriter& writer) {
  TickReader reader(*begin.source);
  RecordedTick tick;
  std::uint64_t& next_number = committed_.next_number;
  while (next_number <= begin.last_number) {
    const Result<bool> more = reader.Next(tick);
    if (!more.ok()) return more.error();
    if (!more.value()) return Error{{begin.source->name()}, "a tick is missing", ErrorCode::kFailure};
    // The ticks of this run are no copies, if it begins within those of a rewind.
    if (tick.edit) tick.edit->copies = std::min(tick.edit->copies, begin.last_number - tick.number);
    if (Status failure = writer.Add(tick); !failure.ok()) return failure;
    next_number = tick.number + 1;
  }
  if (begin.change) {
    if (Status failure = writer.Add(*begin.change); !failure.ok()) return failure;
    next_number = begin.change->number + 1;
  }
  return writer.EndChunk();
}

Status RunRecorder::OnCommit(const CommittedTick& tick, const RunProgress& progress) {
  const std::lock_guard lock(mutex_);
  if (committed_.tail == nullptr) return {};
  if (tick.is_recorded) return WriteProgress(progress);
  committed_.progress = progress;
  return Reported(Write(Convert(tick)));
}

Status RunRecorder::OnProgress(const RunProgress& progress) {
  const std::lock_guard lock(mutex_);
  return WriteProgress(committed_.progress.is_rewinding ? WithinRewind(progress) : progress);
}

Status RunRecorder::OnTick(const CommittedTick& tick) {
  const std::lock_guard lock(mutex_);
  if (tick.is_recorded) committed_.newest = HeadOf(tick.frame);
  if (tick.is_recorded || committed_.tail != nullptr) return Reported(thread_->status());
  return Reported(Write(Convert(tick)));
}

Status RunRecorder::AppendRewind(const TickSource& next) {
  Status outcome = OrFailure([&]() -> Status {
    for (;;) {
      RecordedTick tick;
      const Result<bool> more = next(tick);
      if (!more.ok()) return more.error();
      if (!more.value()) return {};
      // Without the mutex: progress of the run may be reported meanwhile.
      while (!thread_->has_room()) {
        if (Status failure = Flush(); !failure.ok()) return failure;
      }
      const std::lock_guard lock(mutex_);
      tick.number = committed_.next_number++;
      committed_.progress = WithinRewind(std::move(committed_.progress));
      if (Status failure = Write(std::move(tick)); !failure.ok()) return failure;
    }
  });
  if (!outcome.ok()) thread_->Fail(outcome);
  return outcome;
}

Status RunRecorder::Write(RecordedTick tick) {
  Status failure = thread_->status();
  if (failure.ok() && committed_.tail) failure = committed_.tail->Append(&tick, committed_.progress);
  if (failure.ok()) thread_->Push(std::move(tick));
  return failure;
}

Status RunRecorder::WriteProgress(const RunProgress& progress) {
  if (committed_.tail == nullptr || committed_.is_dropped) return {};
  committed_.progress = progress;
  return Reported(committed_.tail->Append(nullptr, progress));
}

Status RunRecorder::Reported(const Status& outcome) {
  if (outcome.ok() || !options_.journal_is_optional || committed_.tail == nullptr) return outcome;
  thread_->Fail(outcome);
  if (!std::exchange(committed_.is_dropped, true)) {
    PrintPlain(stderr,
               "the journal of the run cannot be written ({}): the run cannot be continued if its world service "
               "dies\n",
               outcome.error().message);
    committed_.tail->Discard();
  }
  return {};
}

RecordedTick RunRecorder::Convert(const CommittedTick& tick) {
  const FrameMessage& frame = tick.frame;
  RecordedTick recorded = thread_->Reuse();
  recorded.number = committed_.next_number++;
  recorded.tick = frame.state.tick;
  recorded.edition = frame.edition;
  recorded.state_hash = frame.state_hash;
  recorded.proposals.assign(tick.proposals.begin(), tick.proposals.end());
  recorded.commands.assign(tick.commands.begin(), tick.commands.end());
  recorded.inputs.assign(tick.inputs.begin(), tick.inputs.end());
  recorded.events = frame.events;
  if (tick.edit != nullptr) {
    RecordedEdit& edit = recorded.edit.emplace();
    // The state before the edit makes a keyframe of it: a reader need not step from the last one.
    edit.before = committed_.newest;
    edit.before.state = *tick.before;
    edit.request = tick.edit->request;
    if (tick.edit->world != nullptr) edit.world = *tick.edit->world;
  } else if (frame.state.tick % options_.keyframe_interval == 0 || frame.last) {
    recorded.keyframe = HeadOf(frame);
    recorded.keyframe->state = frame.state;
  }
  committed_.newest = HeadOf(frame);
  return recorded;
}

bool RunRecorder::IsReady() {
  return thread_->has_room();  // after a failure, too: the next tick reports it
}

Status RunRecorder::OnEnd() {
  const Status outcome = thread_->Close();
  const std::lock_guard lock(mutex_);
  return Reported(outcome);
}

RecordingThread::RecordingThread(RecordingWriter writer, Options options)
    : options_(std::move(options)), writer_(std::move(writer)), chunk_ended_(Clock::now()) {}

RecordingThread::~RecordingThread() {
  Join();
}

void RecordingThread::Start() {
  const std::lock_guard lock(mutex_);
  if (!thread_.joinable()) thread_ = std::thread([this] { Run(); });
}

bool RecordingThread::has_room() const {
  const std::lock_guard lock(mutex_);
  return !full_ || !status_.ok();
}

RecordedTick RecordingThread::Reuse() {
  const std::lock_guard lock(mutex_);
  // Ticks of a large world have vectors of thousands of rows: their memory is used again instead of being allocated by
  // one thread and freed by another in every tick.
  if (spare_.empty()) return {};
  RecordedTick tick = std::move(spare_.back());
  spare_.pop_back();
  return tick;
}

void RecordingThread::Push(RecordedTick tick) {
  const std::size_t size = SizeOf(tick);
  {
    const std::lock_guard lock(mutex_);
    if (!status_.ok()) return;
    entries_.push_back({std::move(tick), size});
    size_ += size;
    full_ = full_ || size_ >= options_.queue_bytes;
    ++pushed_;
  }
  changed_.notify_all();
}

Status RecordingThread::Flush() {
  std::unique_lock lock(mutex_);
  const std::uint64_t ticks = pushed_;
  // A number and not a flag: a later call must not be satisfied by the chunk that ends for an earlier one.
  flush_asked_ = std::max(flush_asked_, ticks);
  changed_.notify_all();
  changed_.wait(lock, [&] { return flushed_ >= ticks || !status_.ok(); });
  return status_;
}

Status RecordingThread::Close() {
  Join();
  return status();
}

void RecordingThread::Join() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

Status RecordingThread::status() const {
  const std::lock_guard lock(mutex_);
  return status_;
}

void RecordingThread::Fail(Status failure) {
  {
    const std::lock_guard lock(mutex_);
    if (status_.ok()) status_ = std::move(failure);
  }
  changed_.notify_all();
}

void RecordingThread::Run() {
  Status outcome = OrFailure([this]() -> Status {
    for (bool closed = false; !closed;) {
      std::optional<Work> work = Await();
      if (!work) return {};
      if (Status failure = Write(*work); !failure.ok()) return failure;
      closed = work->closes;
      Finish(std::move(*work));
    }
    return {};
  });
  if (!outcome.ok()) Fail(std::move(outcome));
}

std::optional<RecordingThread::Work> RecordingThread::Await() {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, kMaxDelay,
                    [this] { return closed_ || !entries_.empty() || flush_asked_ > flushed_ || !status_.ok(); });
  if (!status_.ok()) return std::nullopt;
  Work work;
  if (!entries_.empty()) {
    work.tick = std::move(entries_.front().tick);
    size_ -= entries_.front().size;
    entries_.pop_front();
    ++popped_;
    if (size_ <= options_.queue_bytes / 2) full_ = false;
  } else {
    work.closes = closed_;
  }
  work.flushes =
      work.closes || Clock::now() - chunk_ended_ >= kMaxDelay || (flush_asked_ > flushed_ && popped_ >= flush_asked_);
  return work;
}

Status RecordingThread::Write(const Work& work) {
  Status written = work.tick ? writer_.Add(*work.tick) : Status();
  if (written.ok() && work.flushes) {
    written = writer_.EndChunk();
    chunk_ended_ = Clock::now();
  }
  if (written.ok() && writer_.first_unwritten() != first_unwritten_) {
    first_unwritten_ = writer_.first_unwritten();
    if (options_.sync) written = writer_.Sync();
    if (written.ok() && options_.on_written) options_.on_written(first_unwritten_);
  }
  if (!written.ok() || !work.closes) return written;
  written = writer_.Close();
  if (written.ok() && options_.on_closed) options_.on_closed();
  return written;
}

void RecordingThread::Finish(Work work) {
  if (work.tick) {
    work.tick->proposals.clear();
    work.tick->events.clear();
    work.tick->edit.reset();
    work.tick->keyframe.reset();
  }
  {
    const std::lock_guard lock(mutex_);
    if (work.tick && spare_.size() < kMaxSpare) spare_.push_back(std::move(*work.tick));
    if (!work.flushes) return;
    flushed_ = popped_;
  }
  changed_.notify_all();
}

}  // namespace troupe
