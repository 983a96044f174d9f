// The parameters of the controller `lanes`.
//
// Read once, before the first tick. Defaults are listed in docs/controllers.md; 0 for a speed means the speed of the
// drive.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "troupe/controller.h"
#include "troupe/result.h"

namespace troupe {

struct LaneSettings {
  std::optional<std::uint32_t> graph = {};  // its number; nothing: the one nearest to the start
  std::vector<std::string> places;          // to visit, by name
  bool repeat = true;
  double wait = 3.0;  // s, at each place
  // 0: as the drive allows, at most kMaxSpeed
  double speed = 0.0;       // m/s
  double dock_speed = 0.2;  // m/s
  double turn_rate = 0.8;   // rad/s
  double tolerance = 0.1;   // m
  double charge_below = 0.3;
  double charge_to = 0.95;
  double gap = 0.3;         // m: it keeps it to robots and things ahead
  bool close_doors = true;  // behind it
  bool planned = true;      // it takes part in the planned traffic of the lanes
  bool goods = false;       // it brings the goods of flows
  bool keep_place = false;  // it goes back to its last place
  // Before each move of the planned traffic, with this probability, it stands for s between these bounds.
  double delay_probability = 0.0;
  double delay_min = 1.0;  // s
  double delay_max = 5.0;  // s

  static constexpr double kMaxSpeed = 1.0;  // m/s, without `speed`
};

// The error names the controller.
Result<LaneSettings> ParseLaneSettings(const std::string& text);

// The graph of the world, which has all places of the settings. The error names the controller, too.
Result<const LaneGraph*> FindLanes(const LaneSettings& settings, const RobotInfo& info);

}  // namespace troupe
