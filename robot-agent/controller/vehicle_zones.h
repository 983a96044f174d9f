// VehicleZones: what the enabled zones of a vehicle of VDA 5050 3.0 mean for its motion.
//
// The vehicle drives on the lines of edges, and plans no ways of its own. So it does in LINE_GUIDED zones what it does
// anywhere, and PRIORITY and PENALTY ones, which weigh plans, change nothing. It keeps out of BLOCKED zones, enters
// RELEASE ones with a granted request and COORDINATED_REPLANNING ones with a granted path, is slow enough in
// SPEED_LIMIT ones, tells its memory of the ACTION ones that it enters and leaves, and stands before a line on which
// it would drive in another direction than a DIRECTED or BIDIRECTED one allows, unless that line is a trajectory of the
// order. It counts as in a zone when the circle around its box touches it (no part of it is nearer), and as in a
// DIRECTED or BIDIRECTED one when its centre is.
//
// A plain value without a clock.
#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "fleet/vehicle.h"
#include "robot-agent/controller/vehicle_path.h"
#include "troupe/vec2.h"

namespace troupe {

class VehicleZones {
 public:
  // Where the vehicle is.
  struct Place {
    Vec2 at{0.0, 0.0};  // m, W
    std::string map = {};
    double radius = 0.0;      // m
    double braking = 1.0;     // m/s^2
    std::int64_t now_ms = 0;  // since 1970
  };
  struct Limit {
    std::optional<double> room = {};                         // m, until it has to stand before a zone; nothing: any
    double speed = std::numeric_limits<double>::infinity();  // m/s
    std::vector<fleet::VehicleInput> inputs = {};            // what follows for its memory
  };
  // `way`: along the base, from where it is; null: it does not drive now.
  Limit Look(const fleet::VehicleMemory& memory, const Place& place, const VehicleWay* way);

 private:
  struct Meeting;  // with a zone
  struct Sight;    // what a look finds

  // A node that cannot be reached: the order is held until the fleet control changes the order or the zones.
  struct Unreachable {
    std::string zone;  // "SET/ZONE"
    std::string order_id;
    std::uint32_t order_update_id = 0;
    std::uint32_t sequence_id = 0;
  };

  void Heed(const fleet::VehicleMemory& memory, const Place& place, const Meeting& meeting, Sight& sight, Limit& limit);
  void Enter(const fleet::VehicleMemory& memory, const Place& place, const Meeting& meeting, Sight& sight,
             Limit& limit);
  void TellUnreachable(const fleet::VehicleMemory& memory, const Sight& sight, Limit& limit);

  std::map<std::string, std::int64_t> refused_until_;  // ms since 1970, by zone: it asks again after that
  std::optional<Unreachable> unreachable_;
  std::string lost_path_;         // "SET/ZONE", in which it has lost the grant of its path
  bool has_told_inside_ = false;  // a blocked zone
  bool has_told_lost_ = false;    // a release
  bool has_told_path_ = false;    // lost_path_
};

}  // namespace troupe
