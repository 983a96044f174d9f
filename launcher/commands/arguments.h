// Values on the command lines of several commands: poses, goals, and the address of a web server.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "troupe/pose.h"
#include "troupe/result.h"
#include "troupe/robot_command.h"

namespace CLI {
class App;
}

namespace troupe {

// A pose with the rule of scenarios: the height may be left out.
struct PoseText {
  Pose X_WE;  // z is 0 if it was left out
  bool has_height = false;
};

// Reads "X,Y,HEADING" or "X,Y,Z,HEADING", in metres and degrees.
Result<PoseText> ParsePoseText(const std::string& text);

// Reads "X,Y" of each point, and of the last one "X,Y" or "X,Y,HEADING", in metres and degrees. REQUIRES: not empty
Result<Goal> ParseGoalText(const std::vector<std::string>& points);

struct ListenAddress {
  std::string address;
  std::uint16_t port = 0;
};

// "ADDRESS:PORT", with an IPv4 address.
std::optional<ListenAddress> ParseListen(const std::string& text);

// Adds --listen, which sets `listen` to a text that ParseListen reads.
void AddListenOption(CLI::App& command, std::string& listen);

}  // namespace troupe
