// Controllers in shared libraries, good and bad; the build picks one by a definition.
#include <stdexcept>

#include "troupe/controller.h"

namespace {

class TestController final : public troupe::Controller {
 public:
  explicit TestController(const troupe::RobotInfo& info) {
#ifdef VARIANT_throws_at_start
    throw std::invalid_argument("parameters " + info.parameters + " are not to my taste");
#else
    (void)info;
#endif
  }
#ifdef VARIANT_bad_subscription
  std::vector<std::size_t> Subscriptions() const override {
    return {7};
  }
#endif
#ifdef VARIANT_goals
  bool AcceptsGoals() const override {
    return true;
  }
#endif
  troupe::Command Update(const troupe::Observation& observation) override {
#ifdef VARIANT_throws_later
    if (observation.tick >= 3) throw std::runtime_error("out of ideas");
#endif
    troupe::Command command;
    command.twist.vx = 0.25 + 0.0 * observation.Random(0);
#ifdef VARIANT_goals  // the motion shows the first waypoint
    command.twist = {};
    if (observation.goal != nullptr) {
      command.twist.vx = observation.goal->waypoints[0].x();
      command.twist.wz = observation.goal->waypoints[0].y();
    }
#endif
#ifdef VARIANT_bad_lift
    if (observation.tick == 0) command.grippers = {{.fingers = troupe::FingerCommand::kClose }};
    if (observation.tick == 5) command.grippers = {{.lift = 140.0 }};
#endif
    return command;
  }
};

}  // namespace

#ifdef VARIANT_wrong_version
extern "C" int troupe_controller_abi() {
  return TROUPE_CONTROLLER_ABI + 41;
}
extern "C" troupe::Controller* troupe_create_controller(const troupe::RobotInfo& info) {
  return new TestController(info);
}
#elif defined(VARIANT_makes_nothing)
extern "C" int troupe_controller_abi() {
  return TROUPE_CONTROLLER_ABI;
}
extern "C" troupe::Controller* troupe_create_controller(const troupe::RobotInfo&) {
  return nullptr;
}
#else
TROUPE_CONTROLLER(TestController)
#endif
