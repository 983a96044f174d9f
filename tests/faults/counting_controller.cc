// A controller that decides by the number of its calls alone, so that a call too many or too few in a run shows in its
// hashes.
#include <memory>

#include "troupe/controller.h"

namespace {

class CountingController final : public troupe::Controller {
 public:
  explicit CountingController(const troupe::RobotInfo&) {}

  troupe::Command Update(const troupe::Observation&) override {
    ++calls_;
    troupe::Command command;
    command.twist.vx = 0.1 + 0.05 * static_cast<double>(calls_ % 7);
    command.twist.wz = calls_ % 3 == 0 ? 0.5 : -0.2;
    return command;
  }
  std::unique_ptr<troupe::Controller> Clone() const override { return std::make_unique<CountingController>(*this); }

 private:
  unsigned calls_ = 0;
};

}  // namespace

TROUPE_CONTROLLER(CountingController)
