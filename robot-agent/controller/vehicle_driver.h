// VehicleDriver: the motion of a vehicle of VDA 5050 along the base of its order.
//
// It drives along the line of the present edge (vehicle_path.h) towards a point some way ahead on it (pure pursuit: R.
// C. Coulter, Implementation of the Pure Pursuit Path Tracking Algorithm, 1992), so fast that it stops where it has to:
// at the end of the base, at nodes with an orientation or with actions for which it stands, and at corners. Before a
// corner it turns in place, unless it is a car. A vehicle that can drive backwards does so where the orientation of an
// edge asks for it; one with an omni drive takes any orientation.
//
// It stands `gap` before what its body would touch until then. It does not go round: the fleet control finds the way.
//
// A plain value without a clock. Frame W is the map's; poses are the vehicle's own estimate.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "fleet/vehicle.h"
#include "fleet/vehicle_settings.h"
#include "robot-agent/controller/vehicle_path.h"
#include "robot-agent/navigation/surroundings.h"
#include "troupe/controller.h"

namespace troupe {

class VehicleDriver {
 public:
  VehicleDriver(const RobotInfo& info, fleet::VehicleSettings settings);

  // Begins the edge to the first of the nodes, if that is another one than before. Returns the way along it, and on
  // along the base; nothing: no position of that node is known. REQUIRES: the memory has nodes.
  std::optional<VehicleWay> Look(const fleet::VehicleMemory& memory, const Observation& observation);

  struct Motion {
    Command command;
    bool has_reached = false;              // the first of the nodes
    std::optional<ModelId> obstacle = {};  // for which it stands
    double room = 0.0;                     // m, to the end of the base
    std::optional<double> driven = {};     // m, since the last node
  };
  // `most`: m, that it may drive on; nothing: any. `fastest`: m/s. REQUIRES: the memory lets it drive
  // (fleet::MayDrive), and Look has returned a way.
  Motion Drive(const fleet::VehicleMemory& memory, const Observation& observation, const Surroundings& around,
               const std::optional<double>& most, double fastest);
  // m/s, on the first edge of the memory.
  double SpeedOf(const fleet::VehicleMemory& memory) const;
  // It stands, and begins the edge anew when it drives again.
  void Rest() { is_turning_ = false; }
  // It has been moved from outside.
  void Forget();

 private:
  struct Leg;

  std::optional<Vec2> PositionOf(const fleet::Node& node) const;
  void Begin(const fleet::VehicleMemory& memory, const fleet::Node& node, const Pose& X_WR);
  // Of an edge from `start`: whether the vehicle drives it backwards.
  bool IsBackward(const fleet::Edge* edge, const Vec2& direction) const;
  // m from the end of the present edge to where the vehicle has to stop.
  double WayBehind(const fleet::VehicleMemory& memory) const;
  bool StopsAt(const fleet::VehicleMemory& memory, std::size_t node) const;
  double SpeedOf(const fleet::Edge* edge, bool is_backward) const;
  double TurnRateOf(const fleet::Edge* edge) const;
  double TurnBy(double angle, double most, double interval) const;
  std::optional<double> HeadingAt(const fleet::Edge* edge, const Vec2& direction) const;
  Command CommandOf(double speed, double curvature, double turn) const;
  Command Follow(const fleet::VehicleMemory& memory, const Observation& observation, double speed);
  void StopBefore(const fleet::VehicleMemory& memory, const Observation& observation, const Surroundings& around,
                  double to_stop, Motion& motion, double& speed) const;

  RobotId id_;
  DriveDescription drive_;
  fleet::VehicleSettings settings_;
  std::span<const LaneGraph> graphs_;

  std::optional<std::uint32_t> target_;  // the sequence id of the node that it drives to
  std::string target_order_;
  VehiclePath path_;
  bool has_edge_ = false;
  bool is_backward_ = false;
  bool is_turning_ = false;
  double along_ = 0.0;        // m, of the path
  std::optional<Vec2> from_;  // the node before
};

}  // namespace troupe
