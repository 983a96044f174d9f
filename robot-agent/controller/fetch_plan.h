// The plan of a `fetch` controller: its parameters as a sequence of actions. Private to this folder.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "troupe/result.h"

namespace troupe {

enum class FetchAction : std::uint8_t {
  kGoTo,    // turn to the point, then drive there
  kTurnTo,  // heading
  kDrive,   // straight on, or back
  kPush,    // the same, but a contact ends it
  kOpen,    // the fingers
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
  double speed = 0.4;      // m/s
  double turn_rate = 1.0;  // rad/s
  bool needs_gripper = false;
  bool needs_lift = false;
};

// `parameters`: a JSON object. The error names the controller.
Result<FetchPlan> ParseFetchPlan(const std::string& parameters);

}  // namespace troupe
