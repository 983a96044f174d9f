// A controller that is not repeatable, a fault of users: from tick 30 on its speed depends on the process, if its
// parameters ask for that.
#include <unistd.h>

#include <string>

#include "troupe/controller.h"

namespace {

class Drifting final : public troupe::Controller {
 public:
  explicit Drifting(const troupe::RobotInfo& info) : drifts_(info.parameters.find("true") != std::string::npos) {}
  troupe::Command Update(const troupe::Observation& observation) override {
    troupe::Command command;
    command.twist.vx = 0.1;
    if (drifts_ && observation.tick >= 30) command.twist.vx += 1e-9 * getpid();
    return command;
  }

 private:
  bool drifts_;
};

}  // namespace

TROUPE_CONTROLLER(Drifting)
