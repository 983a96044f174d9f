#include "world-service/observers/recorder/make_recorders.h"

#include <utility>

#include "recording/recording.h"
#include "world-service/observers/recorder/run_recorder.h"

namespace troupe {

Result<std::unique_ptr<Recorder>> MakeTextRecorder(const WorldDescription& world, const OutputFiles& files) {
  OutputFiles texts = files;
  if (IsRecordingPath(files.record)) texts.record.clear();
  if (texts.hash_log.empty() && texts.poses.empty() && texts.record.empty()) return std::unique_ptr<Recorder>();
  return Recorder::Create(world, texts);
}

RecordingOptions RecordingOptionsOf(const OutputFiles& files, const std::string& world_file) {
  RecordingOptions options;
  options.world_file = world_file;
  options.keyframe_interval = files.keyframe_interval;
  options.begin = files.begin;
  options.journal = files.journal;
  options.sync = files.journal_sync;
  options.journal_is_optional = files.journal_is_optional;
  return options;
}

Result<Recorders> MakeRecorders(const WorldDescription& world, const OutputFiles& files, const std::string& world_file,
                                bool needs_memory) {
  Recorders recorders;
  RecordingOptions options = RecordingOptionsOf(files, world_file);
  const auto add = [&recorders](const std::string& path, const RecordingOptions& with) -> Status {
    Result<std::unique_ptr<RunRecorder>> recorder = RunRecorder::Create(path, with);
    if (!recorder.ok()) return recorder.error();
    recorders.recordings.push_back(recorder.value().get());
    recorders.observers.push_back(std::move(recorder).value());
    return {};
  };
  if (files.journal) {
    if (Status failure = add(files.journal->recording, options); !failure.ok()) return failure.error();
  }
  options.journal.reset();
  if (IsRecordingPath(files.record)) {
    if (Status failure = add(files.record, options); !failure.ok()) return failure.error();
  }
  if (needs_memory && recorders.recordings.empty()) {
    Result<TemporaryFile> file = TemporaryFile::Create();
    if (!file.ok()) return file.error();
    recorders.temporary = std::move(file).value();
    if (Status failure = add(recorders.temporary->path(), options); !failure.ok()) return failure.error();
  }
  Result<std::unique_ptr<Recorder>> texts = MakeTextRecorder(world, files);
  if (!texts.ok()) return texts.error();
  if (texts.value() != nullptr) recorders.observers.push_back(std::move(texts).value());
  return recorders;
}

}  // namespace troupe
