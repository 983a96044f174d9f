// The observers that write the output files of a run.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/base/temporary_file.h"
#include "troupe/result.h"
#include "troupe/world_description.h"
#include "world-service/observers/recorder/recorder.h"
#include "world-service/observers/recorder/run_recorder.h"
#include "world-service/service/run_observer.h"

namespace troupe {

// The text files of `files`; null: none. As MakeRecorders.
Result<std::unique_ptr<Recorder>> MakeTextRecorder(const WorldDescription& world, const OutputFiles& files);
RecordingOptions RecordingOptionsOf(const OutputFiles& files, const std::string& world_file);

struct Recorders {
  std::optional<TemporaryFile> temporary = {};
  std::vector<std::unique_ptr<RunObserver>> observers = {};
  std::vector<RunRecorder*> recordings = {};  // of them, those that write recordings
};

// Creates the files. The world outlives the observers; `world_file` is the file that it was loaded from.
// `needs_memory`: a run that has no recording otherwise has one in a temporary file. The error names the file that
// cannot be written.
Result<Recorders> MakeRecorders(const WorldDescription& world, const OutputFiles& files, const std::string& world_file,
                                bool needs_memory = false);

}  // namespace troupe
