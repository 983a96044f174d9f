// RunExport: the states of a recorded run in a format of other programs. docs/recording.md has the topics and columns.
//
// An export steps the recording again and is called with each state: what a format needs beyond the state (readings of
// sensors, pictures) is measured from it, with the bits that the robots had. The formats have nothing in common but
// this interface, because each is the contract of another program.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "common/sensing/sensor_suite.h"
#include "common/spatial/scene.h"
#include "troupe/result.h"
#include "world-service/replay/replayed_world.h"

namespace troupe {

class RunExport {
 public:
  virtual ~RunExport() = default;

  // A state of the run, the events that led to it, and its time (ns since the start of the recording, which never
  // decreases). The world may be another one than in the call before. An error is that of a file.
  virtual Status Add(const ReplayedWorld& world, std::uint64_t time) = 0;
  // Completes the files.
  virtual Status Close() = 0;
};

// For Foxglove, Lichtblick and Rerun: an MCAP file with the messages of foxglove's schemas as JSON.
Result<std::unique_ptr<RunExport>> MakeFoxgloveExport(const std::string& file);

// For `ros2 bag`: a bag, which is a folder with an MCAP file and its metadata.yaml; or, with a name that ends in .mcap,
// that file alone.
Result<std::unique_ptr<RunExport>> MakeRos2Export(const std::string& path);
// The files that it writes, that of the messages first.
std::vector<std::string> FilesOfRos2Export(const std::string& path);

// For tables: a folder with a file for each kind of row; or, with a name that ends in .csv, the poses alone.
Result<std::unique_ptr<RunExport>> MakeCsvExport(const std::string& path);
// The files that it writes.
std::vector<std::string> FilesOfCsvExport(const std::string& path);

// For the League of Robot Runners: its JSON of the outcome of a run on a map of cells. `problem`: the file of the run,
// which has the tasks, if it is there.
Result<std::unique_ptr<RunExport>> MakeLeagueExport(const std::string& file, const std::string& problem);

// RunReadings: the readings of all sensors of a run that are due at a state.
// Suites of sensors are made per robot when first needed, and all again in another world.
class RunReadings {
 public:
  // `world` is the newest state; the readings are of it.
  void SetState(const ReplayedWorld& world) {
    world_ = &world;
    if (scene_ == world.scene()) return;
    scene_ = world.scene();
    suites_.clear();
  }
  bool IsDue(RobotId robot, std::size_t sensor) const {
    return world_->state().tick % world_->world().robot(robot).sensors[sensor].period_ticks == 0;
  }
  // Valid until the next call for the robot. REQUIRES: SetState was called.
  const SensorReading& Measure(RobotId robot, std::size_t sensor) {
    SensorSuite& suite = suites_.try_emplace(robot, *scene_, robot).first->second;
    return suite.Measure(sensor, {*scene_, world_->bodies()}, world_->state().tick);
  }

 private:
  const ReplayedWorld* world_ = nullptr;
  std::shared_ptr<const Scene> scene_;
  std::map<RobotId, SensorSuite> suites_;
};

}  // namespace troupe
