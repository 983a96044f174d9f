#include "world-service/observers/recorder/make_recorders.h"

#include <utility>

#include "common/recording/recording.h"
#include "world-service/observers/recorder/run_recorder.h"

namespace troupe {

Result<std::vector<std::unique_ptr<RunObserver>>> MakeRecorders(const WorldDescription& world, const OutputFiles& files,
                                                                const std::string& world_file) {
  std::vector<std::unique_ptr<RunObserver>> recorders;
  OutputFiles texts = files;
  if (IsRecordingPath(files.record)) {
    texts.record.clear();
    RecordingOptions options;
    options.world_file = world_file;
    options.keyframe_interval = files.keyframe_interval;
    Result<std::unique_ptr<RunRecorder>> recorder = RunRecorder::Create(files.record, options);
    if (!recorder.ok()) return recorder.error();
    recorders.push_back(std::move(recorder).value());
  }
  Result<std::unique_ptr<Recorder>> recorder = Recorder::Create(world, texts);
  if (!recorder.ok()) return recorder.error();
  recorders.push_back(std::move(recorder).value());
  return recorders;
}

}  // namespace troupe
