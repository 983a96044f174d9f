// VehicleSite: the doors and lifts of a building on the way of a vehicle of VDA 5050. Orders know nothing of them: an
// edge leads through a doorway, and two nodes at one place in a cabin, on the maps of two floors, are a ride.
//
// The way is made into lanes of its own, whose doors and lifts are operated as those of a building's lanes are
// (site_controls.h): requested, awaited outside of all that moves, passed, and closed or released behind the vehicle.
//
// A plain value. Distances are along the way, in m, from where the vehicle is.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "robot-agent/controller/site_controls.h"
#include "robot-agent/controller/vehicle_path.h"
#include "robot-agent/navigation/surroundings.h"
#include "troupe/controller.h"

namespace troupe {

class VehicleSite {
 public:
  explicit VehicleSite(const RobotInfo& info);

  // Begins a tick; the observation and the command live until its end.
  void Begin(const Observation& observation, const Surroundings& around, Command& command);

  struct Limit {
    std::optional<double> room = {};    // to where it has to stop; nothing: it may drive
    std::optional<ModelId> thing = {};  // the door or the lift for which it waits there
    bool is_stuck = false;              // a door that does not move
    bool rides = false;                 // it is in a cabin that is to bring it to the first node
    bool has_no_lift = false;           // the first node is on another map, and no lift leads there
  };
  // Requests what is needed along the way.
  Limit Follow(const VehicleWay& way);
  // The vehicle does not drive in this tick. `has_way`: it will go on later.
  void Rest(bool has_way);

 private:
  struct Doorway {
    std::size_t door = 0;
    Vec2 left{0.0, 0.0};  // the ends of its closed leaves, W
    Vec2 right{0.0, 0.0};
  };

  void FindDoorways();
  void MakeGraph(const VehicleWay& way);
  std::optional<std::uint32_t> LiftAround(const Vec2& place) const;
  std::vector<LaneDoor> DoorsOn(const Vec2& from, const Vec2& to, double z) const;
  double ZOf(const std::string& map, double z) const;
  bool IsInCabin() const;
  void LimitByLift(Limit& limit, std::vector<std::size_t>& needed);
  void LimitByDoors(Limit& limit);
  void End(const std::vector<std::size_t>& needed);
  void Limited(Limit& limit, double room, ModelId thing, bool is_stuck) const;
  // To the place before a doorway of the lift at the vertex where it waits; 0: it is there.
  double WayToLift(std::size_t vertex) const;

  RobotId id_;
  std::vector<LiftInfo> lifts_;
  std::vector<DoorInfo> doors_;
  std::optional<std::vector<Doorway>> doorways_;  // nothing: not yet looked for
  LaneGraph graph_;                               // of the tick: a vertex for each point of the way
  std::vector<Leg> legs_;
  SiteControls controls_;
  double radius_ = 0.0;  // m, its own
  std::vector<double> radii_;
  std::vector<SeenRobot> others_;
  const Observation* now_ = nullptr;  // of the tick, as the next
  const Surroundings* around_ = nullptr;
};

// The map on which a vehicle is at that height: the level of a building, or the one that its parameter names.
std::string MapAt(const std::string& parameter, const WorldDescription& world, double z);
// All maps that it has.
std::vector<std::string> MapsOf(const std::string& parameter, const WorldDescription& world);

}  // namespace troupe
