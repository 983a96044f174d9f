// VehicleZones: what the enabled zones of a vehicle of VDA 5050 3.0 mean for its motion.
//
// The vehicle drives on the lines of edges, and plans no ways of its own. So zones that concern the choice of a way
// (LINE_GUIDED, COORDINATED_REPLANNING, PRIORITY, PENALTY, DIRECTED, BIDIRECTED) change nothing. It keeps out of
// BLOCKED ones, enters RELEASE ones with a granted request, and is slow enough in SPEED_LIMIT ones. It counts as in a
// zone when the circle around its box touches it: no part of it is nearer.
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

  void Enter(const fleet::VehicleMemory& memory, const Place& place, const Meeting& meeting, bool keeps, Limit& limit);

  std::map<std::string, std::int64_t> refused_until_;  // ms since 1970, by zone: it asks again after that
  bool has_told_inside_ = false;                       // a blocked zone
  bool has_told_ahead_ = false;                        // a blocked zone
  bool has_told_lost_ = false;                         // a release
};

}  // namespace troupe
