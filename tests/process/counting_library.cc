// A controller with a global variable, a fault of users: its speed is the number of controllers that the process has
// made before. With the parameter "stuck" it does not return at tick 3.
#include <string>

#include "troupe/controller.h"

namespace {

int g_made = 0;

class Counting final : public troupe::Controller {
 public:
  explicit Counting(const troupe::RobotInfo& info)
      : is_stuck_(info.parameters.find("stuck") != std::string::npos), number_(g_made++) {}
  troupe::Command Update(const troupe::Observation& observation) override {
    volatile int count = 0;
    while (is_stuck_ && observation.tick >= 3) {
      count = count + 1;
    }
    troupe::Command command;
    command.twist.vx = 0.01 * number_;
    return command;
  }

 private:
  bool is_stuck_;
  int number_;
};

}  // namespace

TROUPE_CONTROLLER(Counting)
