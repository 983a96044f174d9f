// Recorder: writes the files that a run leaves behind, one line or more for each frame. A frame after an edit has the
// tick of the one before, or an earlier one.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "common/protocol/messages.h"
#include "world-service/service/output_file.h"

namespace troupe {

// Files to write while running; empty: none. docs/running.md has their formats.
struct OutputFiles {
  std::string hash_log;  // "tick hash" a line
  std::string poses;     // CSV: tick,robot,x,y,z,heading,stalled; with more columns for joints and objects
  std::string record;    // JSON lines: header, then a line for each tick
};

class Recorder {
 public:
  // Creates the files. The world must stay until it is changed for another one.
  static Result<Recorder> Create(const WorldDescription& world, const OutputFiles& files);

  // An edit has changed the world: the record gets a header for it. The next Write tells if that failed.
  void ChangeWorld(const WorldDescription& world, Edition edition);

  // The error is the first that a file had (a full disk); what follows is not written.
  Status Write(const FrameMessage& frame);
  Status Close();

 private:
  explicit Recorder(const WorldDescription& world) : world_(&world) {}
  Status WriteRecordHeader(std::optional<Edition> edition);
  void TakeNames();
  Status WriteHash(const FrameMessage& frame);
  Status WritePosesHeading();
  Status WritePoses(const FrameMessage& frame);
  Status WriteObjectPoses(const WorldState& state);
  Status WriteJointPoses(const WorldState& state);
  // tick,name,x,y,z,heading,flag
  void AppendPose(Tick tick, ModelId model, const Pose& X_WM, bool flag);
  Status WriteRecord(const FrameMessage& frame);
  void AppendJoints(const WorldState& state);
  void AppendGrippers(const WorldState& state);
  void AppendObjects(const WorldState& state);
  // The world has joints or objects, and the files say so; the poses, if the first world had.
  bool manipulates() const { return !world_->joints.empty() || !world_->objects.empty(); }

  const WorldDescription* world_;
  bool wide_poses_ = false;              // with the columns for joints and objects
  std::vector<std::string> csv_names_;   // by model, quoted where CSV needs it
  std::vector<std::string> json_names_;  // by model, quoted; empty without joints and objects
  std::optional<OutputFile> hash_log_;
  std::optional<OutputFile> poses_;
  std::optional<OutputFile> record_;
};

}  // namespace troupe
