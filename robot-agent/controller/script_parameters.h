// The parameters of the controller `script`, as read from JSON; docs/controllers.md has their format.
//
// This is the form of the file: names are not resolved, because a scenario is checked without a robot. The first error
// ends the reading; it names the command by its number, from 1.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "troupe/controller.h"
#include "troupe/result.h"

namespace troupe {

// The part of a command for one gripper. Without a name: for the robot's only one.
struct ScriptGripper {
  std::string name;
  std::optional<FingerCommand> fingers = {};
  std::optional<double> lift = {};  // percent
};

struct ScriptJoint {
  std::string name;
  double position = 0.0;  // m or rad
};

struct ScriptCamera {
  std::string name;
  double pan = 0.0;  // rad
  double tilt = 0.0;
};

struct ScriptCommand {
  double at = 0.0;          // s, simulated
  Command motion;           // its twist, or a car's speed and steering; no more
  bool for_car = false;     // it gives speed or steering
  bool for_others = false;  // it gives vx, vy or wz
  std::vector<ScriptGripper> grippers;
  std::vector<ScriptJoint> joints;
  std::vector<std::pair<std::string, bool>> lights;        // by name: on
  std::vector<std::pair<std::string, double>> doors;       // by name: opening, from 0 to 1
  std::vector<std::pair<std::string, std::string>> lifts;  // by name: a floor; empty: ends the session
  std::vector<ScriptCamera> cameras;
  std::optional<std::string> say;   // a text for the log of events
  std::optional<std::string> send;  // a text, by the robot's first radio to all in range
};

struct ScriptParameters {
  std::vector<ScriptCommand> commands;  // never empty, in order of their times
  double period = 0.0;                  // s; 0: no repetition
};

// The error names the controller.
Result<ScriptParameters> ParseScript(const std::string& text);

}  // namespace troupe
