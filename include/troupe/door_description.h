// The doors and lifts of a WorldDescription: devices that the step moves, each at a model that never moves itself.
// Leaves and cabins are objects; DoorState and LiftState (world_state.h) have their motion.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "troupe/fields.h"
#include "troupe/ids.h"
#include "troupe/pose.h"

namespace troupe {

// A leaf of a door: an object that only its door moves.
struct DoorLeaf {
  ObjectId object;
  Pose X_WH;
  double turn = 0.0;
  double shift = 0.0;
  bool operator==(const DoorLeaf&) const = default;

  // At an opening from 0, closed, to 1.
  Pose X_WH_at(double opening) const { return X_WH * Pose{opening * shift, 0.0, 0.0, WrapAngle(opening * turn)}; }
  static constexpr auto Fields() {
    return std::tuple{
        Field{"object", &DoorLeaf::object},
        Field{"closed", &DoorLeaf::X_WH, "of the object's root while the door is closed, in W"},
        Field{"turn", &DoorLeaf::turn, "of a door that opens: the leaf turns about the origin of H"}.In("rad").Within(
            -2 * kPi, 2 * kPi),
        Field{"shift", &DoorLeaf::shift, "or slides along the x axis of H; one of both is 0"}.In("m"),
    };
  }
};

// One or more leaves that open and close together.
struct DoorDescription {
  ModelId model;
  std::vector<DoorLeaf> leaves;
  double seconds = 3.0;
  double detection_radius = 0.0;
  double sensor_width = 0.0;
  double sensor_depth = 0.0;
  double hold = 0.0;
  bool reopens = false;
  double opening = 0.0;
  bool is_operated = true;
  bool operator==(const DoorDescription&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"model", &DoorDescription::model, "has no body; its name is the door's"},
        Field{"leaves", &DoorDescription::leaves},
        Field{"seconds", &DoorDescription::seconds, "from closed to open"}.In("s").AtLeast(1e-3),
        Field{"reach", &DoorDescription::detection_radius, "it opens for robots nearer to its model; 0: for none"}
            .In("m")
            .AtLeast(0),
        Field{"sensor_width", &DoorDescription::sensor_width,
              "of the region along the doorway that opens it for robots and people; 0: that of the doorway"}
            .In("m")
            .AtLeast(0),
        Field{"sensor_depth", &DoorDescription::sensor_depth,
              "of that region across the doorway, from its middle to both sides; 0: it has no such sensor"}
            .In("m")
            .AtLeast(0),
        Field{"hold", &DoorDescription::hold, "that it stays open once nothing holds it open any more"}.In("s").Within(
            0, 3600),
        Field{"reopens", &DoorDescription::reopens, "a body that stops it while it closes opens it again, all the way"},
        Field{"opening", &DoorDescription::opening, "at load: 0 is closed, 1 open"}.Within(0, 1),
        Field{"operated", &DoorDescription::is_operated, "if not, requests have no effect"},
    };
  }
};

// A height at which a lift stops.
struct LiftFloor {
  std::string name;
  double z = 0.0;
  std::vector<std::size_t> doors;
  bool operator==(const LiftFloor&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"name", &LiftFloor::name},
        Field{"z", &LiftFloor::z, "of the cabin's floor"}.In("m"),
        Field{"doors", &LiftFloor::doors, "of the cabin and of the shaft, open here; in WorldDescription::doors"},
    };
  }
};

// A cabin that moves along z, with its contents, while all of its doors are closed.
struct LiftDescription {
  ModelId model;
  ObjectId cabin;
  std::vector<std::size_t> cabin_doors;
  std::vector<LiftFloor> floors;
  std::uint32_t floor = 0;
  double speed = 1.0;
  std::int32_t capacity = 0;
  double max_load = 0.0;
  bool operator==(const LiftDescription&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"model", &LiftDescription::model, "has no body; its name is the lift's"},
        Field{"cabin", &LiftDescription::cabin, "moved by the lift alone; at the height of the floor at load"},
        Field{"cabin_doors", &LiftDescription::cabin_doors, "moving with the cabin, in WorldDescription::doors"},
        Field{"floors", &LiftDescription::floors},
        Field{"floor", &LiftDescription::floor, "at load"},
        Field{"speed", &LiftDescription::speed, "of the cabin"}.In("m/s").AtLeast(1e-3),
        Field{"capacity", &LiftDescription::capacity,
              "robots and people in the cabin, with more of which it does not leave a floor; 0: any number"}
            .Within(0, 10000),
        Field{"max_load", &LiftDescription::max_load, "likewise, their mass; 0: any"}.In("kg").AtLeast(0),
    };
  }
};

}  // namespace troupe
