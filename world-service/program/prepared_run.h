// PreparedRun: the world, the options, the output files and the observers with which a world service begins a run, or
// continues one. The program world-service and `troupe run --in-process` prepare theirs by the same calls.
//
// Three origins: a world or scenario file begins a run; a recording is branched at a tick; a journal is resumed at its
// newest state. PrepareRun reads, and writes only to a journal that it continues, so that a wrong option leaves no file
// behind; MakeObservers creates the output files and opens ROS, and is called when nothing else can fail.
//
// Members are destroyed in reverse order: the gateway and the history before the recorders that they read.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "command_line/run_flags.h"
#include "common/run/run_settings.h"
#include "common/spatial/scene.h"
#include "ros/messages/ros_options.h"
#include "troupe/result.h"
#include "world-service/observers/recorder/recorder.h"
#include "world-service/program/fleet_flags.h"
#include "world-service/service/requested_file.h"
#include "world-service/service/run_history.h"
#include "world-service/service/run_service.h"
#include "worldfile/load_world.h"

namespace troupe {

// What the owner of a run asks for.
struct RunSource {
  std::string file;         // a world, a scenario, or a recording that is continued; may be empty with `resume`
  LoadOverrides overrides;  // of the file
  BranchFlags branch;       // of a recording
  RunOverrides run;         // of the settings of the file
  OwnerPermissions permissions;
  ServiceOptions service;  // without what follows from the file
  OutputFiles outputs;
  ros::RosOptions ros = ros::OptionsFromEnvironment();
  FleetOptions fleet;
  std::optional<std::uint32_t> domain;  // of the run on DDS, which its robots cannot have in ROS; nothing: none
  bool resume = false;                  // the run of the journal in `outputs`
  Incarnation successor = 1;            // with `resume`: the number of this service among those that were started again
};

struct PreparedRun {
  std::shared_ptr<const Scene> scene;  // of a run that is continued: now
  std::vector<std::string> files;      // that were loaded
  std::shared_ptr<const Site> site;    // of a building; null: none, or it is not here
  std::string site_world;              // the name of the world of that; a run that is continued may have another one
  ServiceOptions options;
  std::shared_ptr<const WorldDescription> first_world;  // of which the recorders have the names
  std::shared_ptr<const RecordedStart> begin;           // of the recordings; null: they begin with the run
  std::vector<NamedExpectation> expectations;           // of the scenario, for recordings that begin with the run
  std::vector<NamedRegion> regions;
  Recorders recorders;
  std::unique_ptr<RunHistory> history;         // null: none
  std::unique_ptr<RunObserver> gateway;        // to ROS 2; null: none
  std::unique_ptr<RunObserver> fleet_gateway;  // by VDA 5050; null: none
  RosLockstep ros_lockstep;                    // of the scenario, with the values of the command line

  const WorldDescription& world() const { return scene->world(); }
};

// Loads the file of the source, whose warnings are printed, or the newest state of the journal to be resumed. If that
// journal has no run yet, the file. The error is also one of the domains of the robots in ROS.
Result<PreparedRun> PrepareRun(const RunSource& source);

// Makes the output files, the history and the gateway; call it once nothing else can fail. The observers, in the order
// of their calls, live as long as the run.
Result<RunObservers> MakeObservers(PreparedRun& run, const RunSource& source);

// SessionLock: at most one world service for each session and domain on a host. The lock ends with the process,
// by whatever cause. The transport detects services on other hosts.
class SessionLock {
 public:
  // The error names the process that owns the lock.
  static Result<SessionLock> Acquire(std::uint32_t domain, const std::string& session);

  SessionLock(SessionLock&& other) noexcept;
  SessionLock& operator=(SessionLock&&) = delete;
  ~SessionLock();

 private:
  explicit SessionLock(int socket) : socket_(socket) {}

  int socket_;
};

}  // namespace troupe
