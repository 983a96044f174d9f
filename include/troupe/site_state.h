// What an operator and the robots of a site change in a run, as a part of a WorldState: rules of lanes, zones, the
// turns of robots at chargers, and goods on their way.
//
// Vertices and lanes are counted through all graphs of the world, in their order (WorldDescription::lane_graphs).
#pragma once

#include <cstdint>
#include <optional>

#include "troupe/fields.h"
#include "troupe/ids.h"

namespace troupe {

// A lane that an operator has closed, or on which robots drive more slowly.
struct LaneRule {
  std::uint32_t lane = 0;
  double speed_limit = 0.0;
  bool operator==(const LaneRule&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"lane", &LaneRule::lane},
        Field{"speed_limit", &LaneRule::speed_limit, "0: closed"}.In("m/s").AtLeast(0),
    };
  }
};

struct ZoneState {
  bool is_on = true;
  std::uint32_t covered = 0;
  bool operator==(const ZoneState&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"on", &ZoneState::is_on, "it has its effect"},
        Field{"covered", &ZoneState::covered, "cells of a cleaning zone that a robot has been on"},
    };
  }
};

// 32 cells of a cleaning zone, from the lowest bit on.
struct CoverageState {
  std::uint32_t cells = 0;
  bool operator==(const CoverageState&) const = default;
  static constexpr auto Fields() { return std::tuple{Field{"cells", &CoverageState::cells, "a bit for each"}}; }
};

// A robot that wants to charge, and the vertex that it has for itself meanwhile.
struct ChargingRobot {
  RobotId robot;
  Tick since = 0;
  std::optional<std::uint32_t> vertex = {};
  bool at_charger = false;
  bool operator==(const ChargingRobot&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"robot", &ChargingRobot::robot},
        Field{"since", &ChargingRobot::since, "of its request"}.In("tick"),
        Field{"vertex", &ChargingRobot::vertex, "that it goes to or is at, which no other one gets; none: it waits"},
        Field{"at_charger", &ChargingRobot::at_charger, "the vertex is a charger, not a place where it waits for one"},
    };
  }
};

// The goods of a GoodsFlow so far.
struct FlowState {
  std::uint32_t arrived = 0;
  std::uint32_t refused = 0;
  std::uint32_t delivered = 0;
  std::uint32_t late = 0;
  Tick lateness = 0;
  bool operator==(const FlowState&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"arrived", &FlowState::arrived, "goods so far, with the stock at load"},
        Field{"refused", &FlowState::refused, "goods for which there was no room at the start"},
        Field{"delivered", &FlowState::delivered, "goods that are where they have to be"},
        Field{"late", &FlowState::late, "of the delivered ones, after their due times"},
        Field{"lateness", &FlowState::lateness, "of these, added up"}.In("tick"),
    };
  }
};

// Goods of a flow that have to be brought to its end.
struct Job {
  std::uint32_t flow = 0;
  std::uint32_t number = 0;
  Tick since = 0;
  Tick due = 0;
  std::optional<RobotId> robot = {};
  bool is_loaded = false;
  bool operator==(const Job&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"flow", &Job::flow, "in WorldDescription::flows"},
        Field{"number", &Job::number, "among the goods of the flow, from 0 on"},
        Field{"since", &Job::since, "of the arrival of the goods"}.In("tick"),
        Field{"due", &Job::due, "of the delivery"}.In("tick"),
        Field{"robot", &Job::robot, "that brings them; none: not assigned yet"},
        Field{"loaded", &Job::is_loaded, "the robot has them"},
    };
  }
};

}  // namespace troupe
