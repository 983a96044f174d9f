// VehicleActions: what a vehicle of VDA 5050 does for the actions of its order and for instant actions, with their
// effects on the world.
//
// Loads: by the first gripper of the robot, if it has one, else by a hand-over (LoadOrder) after `load_time`. An action
// ends as the world says: a load that is not there, a place that is taken, a charger that gives nothing fail.
//
// A plain value: the progress of started actions, by their ids.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "fleet/vehicle.h"
#include "fleet/vehicle_settings.h"
#include "robot-agent/controller/vehicle_readings.h"
#include "robot-agent/navigation/surroundings.h"
#include "troupe/controller.h"

namespace troupe {

class VehicleActions {
 public:
  VehicleActions(const RobotInfo& info, fleet::VehicleSettings settings);

  // Works on the started actions of the memory for a tick. What has happened to them is to be applied to the memory.
  std::vector<fleet::ActionProgress> Work(const fleet::VehicleMemory& memory, const Observation& observation,
                                          const Surroundings& around, Command& command);

 private:
  struct Ongoing {
    std::string id;
    double worked = 0.0;  // s, without pauses
    std::size_t phase = 0;
    std::size_t place = 0;  // the one that is tried
    std::optional<ModelId> load = {};
  };
  // Of one action in a tick.
  struct Turn {
    const fleet::TrackedAction& tracked;
    Ongoing& own;
    const fleet::VehicleMemory& memory;
    const Observation& observation;
    const Surroundings& around;
    Command& command;
    std::vector<fleet::ActionProgress>& progress;
  };

  Ongoing& OngoingOf(const std::string& id);
  void Act(Turn& turn) const;
  void Pick(Turn& turn) const;
  void Drop(Turn& turn) const;
  void PickByGripper(Turn& turn) const;
  void DropByGripper(Turn& turn) const;
  void Charge(Turn& turn) const;
  void InitializePosition(Turn& turn) const;
  void Detect(Turn& turn) const;
  // The places where a load may be put down, in the order in which they are tried.
  std::vector<Vec2> PlacesFor(const Turn& turn, const VehicleLoad& load) const;

  void End(Turn& turn, fleet::ActionStatus status, const std::string& result) const;
  // `type`: as before 3.0.
  void Fail(Turn& turn, const std::string& type, const std::string& reason) const;

  RobotId id_;
  fleet::VehicleSettings settings_;
  std::optional<GripperInfo> gripper_;
  std::vector<Ongoing> ongoing_;
};

// The name of an error of the vehicle's own: "loadNotFound", in 3.0 "LOAD_NOT_FOUND".
std::string ErrorName(const std::string& name, fleet::Version version);

}  // namespace troupe
