// A controller with a fault that ends its process, always at the same tick.
#include <cstdlib>

#include "troupe/controller.h"

namespace {

class Aborting final : public troupe::Controller {
 public:
  explicit Aborting(const troupe::RobotInfo&) {}
  troupe::Command Update(const troupe::Observation& observation) override {
    if (observation.tick == 20) std::abort();
    return {};
  }
};

}  // namespace

TROUPE_CONTROLLER(Aborting)
