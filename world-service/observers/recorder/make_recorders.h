// The observers that write the output files of a run.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "common/model/world_description.h"
#include "world-service/observers/recorder/recorder.h"
#include "world-service/observers/recorder/run_recorder.h"
#include "world-service/service/run_observer.h"

namespace troupe {

// The text files of `files`; null: none. As MakeRecorders.
Result<std::unique_ptr<Recorder>> MakeTextRecorder(const WorldDescription& world, const OutputFiles& files);
RecordingOptions RecordingOptionsOf(const OutputFiles& files, const std::string& world_file);

// Creates the files. The world outlives the observers; `world_file` is the file that it was loaded from. The error
// names the file that cannot be written.
Result<std::vector<std::unique_ptr<RunObserver>>> MakeRecorders(const WorldDescription& world, const OutputFiles& files,
                                                                const std::string& world_file);

}  // namespace troupe
