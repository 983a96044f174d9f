// Recorder: an observer that writes the text files of a run, one line or more for each frame. A frame after an edit has
// the tick of the one before, or an earlier one.
//
// Text files are for scripts and for comparisons by `diff`: two runs of one simulation give equal bytes. So lines
// contain nothing that depends on processes, hosts or time. Numbers are written with the digits that read back to the
// same bits. Recordings in MCAP are written by RunRecorder, from which a run can be continued; this one cannot.
//
// Lines are written on the thread of the tick, into a buffer of the file; rows of removed entities are left out of the
// poses and keep their place in the record, whose columns are positions in the header's lists.
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/base/file.h"
#include "common/base/json_writer.h"
#include "common/base/output_file.h"
#include "common/run/run_settings.h"
#include "common/signals/state_tables.h"
#include "recording/journal.h"
#include "troupe/result.h"
#include "troupe/world_description.h"
#include "world-service/observers/recorder/run_recorder.h"
#include "world-service/service/run_observer.h"

namespace troupe {

// A cell of a CSV file: in quotation marks if it needs them.
std::string QuoteForCsv(const std::string& text);

// Files to write while running; empty: none. docs/running.md has their formats.
struct RecordedStart;

struct OutputFiles {
  std::string hash_log = {};  // "tick hash" a line
  std::string poses = {};     // CSV: tick,robot,x,y,z,heading,stalled; with more columns for all but robots
  std::string record = {};    // a recording if it ends in .mcap; else JSON lines: header, then a line for each tick
  std::uint64_t keyframe_interval = kDefaultKeyframeInterval;  // of a recording
  std::shared_ptr<const RecordedStart> begin = {};  // of the recording and the journal; null: they begin with the run
  // Of the scenario, for recordings that begin with the run.
  std::vector<NamedExpectation> expectations = {};
  std::vector<NamedRegion> regions = {};
  // A journal, from which another service can continue the run; nothing: none.
  std::optional<JournalFiles> journal = {};
  JournalSync journal_sync = JournalSync::kNo;
  bool journal_is_optional = false;  // the run continues without one that cannot be written
};

class Recorder final : public RunObserver {
 public:
  // Creates the files; `record` is not a recording. The world outlives the recorder. The error names the file that
  // cannot be written.
  static Result<std::unique_ptr<Recorder>> Create(const WorldDescription& world, const OutputFiles& files);

  // The error is the first one of a file (a full disk); later frames are not written to it.
  Status OnTick(const CommittedTick& tick) override { return Write(tick.frame); }
  // The record gets a header for the new description.
  void OnWorldChange(const std::shared_ptr<const Scene>& scene, Edition edition) override;
  // Closes the files.
  Status OnEnd() override;

 private:
  explicit Recorder(const WorldDescription& world) : world_(&world) {}
  Status Write(const FrameMessage& frame);
  // Writes buffered lines once in a while, so that little is lost with the process.
  Status FlushSometimes();
  Status WriteRecordHeader(std::optional<Edition> edition);
  void QuoteNames();
  Status WriteHash(const FrameMessage& frame);
  Status WritePosesHeading();
  Status WritePoses(const FrameMessage& frame);
  Status WriteObjectPoses(const WorldState& state);
  Status WritePeoplePoses(const WorldState& state);
  Status WriteJointPoses(const WorldState& state);
  Status WriteDevicePoses(const WorldState& state);  // of doors and lifts
  // tick,name,x,y,z,heading,flag
  void AppendPose(Tick tick, ModelId model, const Pose& X_WM, bool flag);
  Status WriteRecord(const FrameMessage& frame);
  static void WriteJoints(const WorldState& state, JsonWriter& json);
  void WriteName(const std::optional<ModelId>& model, JsonWriter& json) const;
  void WriteGrippers(const WorldState& state, JsonWriter& json) const;
  void WriteObjects(const WorldState& state, JsonWriter& json) const;
  // The other tables of the state that have things: "doors":[[...],...].
  void WriteTables(const WorldState& state, JsonWriter& json) const;
  // Whether the files contain joints and objects: the record if the world has any, the poses if the first world had.
  bool manipulates() const { return !world_->joints.empty() || !world_->objects.empty(); }

  const WorldDescription* world_;
  std::shared_ptr<const Scene> scene_;  // of world_, after an edit
  bool wide_poses_ = false;             // with the columns for objects, people and joints
  std::vector<std::string> csv_names_;  // by model, quoted where CSV needs it
  std::string line_;                    // of the record, while it is written
  std::optional<Things> things_;        // of world_, for a record
  std::optional<OutputFile> hash_log_;
  std::optional<OutputFile> poses_;
  std::optional<OutputFile> record_;
  std::chrono::steady_clock::time_point flushed_at_ = std::chrono::steady_clock::now();
};

// The observers that write the output files of a run.

// Whether there are text files among them.
bool WritesTexts(const OutputFiles& files);

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
