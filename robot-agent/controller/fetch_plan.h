// What a `fetch` controller is told to do: its parameters, broken down into actions. Private to this folder.
#pragma once

#include <string>
#include <vector>

namespace troupe {

enum class FetchAction : std::uint8_t {
  kGoTo,       // turn to the point, then drive there
  kTurnTo,     // heading
  kDrive,      // straight on, or back
  kPush,       // the same, until something stops it
  kOpen,       // the fingers
  kClose,
  kLift,       // to a percentage
  kWait,       // seconds
  kWaitUntil,  // simulated time
};

struct FetchStep {
  FetchAction action = FetchAction::kWait;
  double value = 0.0;  // rad, m, percent or s
  double x = 0.0;      // m, in the frame of the pose estimate
  double y = 0.0;
};

struct FetchPlan {
  std::vector<FetchStep> steps;
  double speed = 0.4;        // m/s
  double turn_rate = 1.0;    // rad/s
  bool needs_gripper = false;
  bool needs_lift = false;
};

// "" or what is wrong with the parameters, a JSON object.
std::string ParseFetchPlan(const std::string& parameters, FetchPlan& plan);

}  // namespace troupe
