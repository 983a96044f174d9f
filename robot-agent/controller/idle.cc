// idle: stands still.
#include "robot-agent/controller/built_in.h"
#include "troupe/parameters.h"

namespace troupe {
namespace {

class IdleController final : public Controller {
 public:
  Command Update(const Observation&) override { return {}; }
  std::unique_ptr<Controller> Clone() const override { return std::make_unique<IdleController>(*this); }
};

Status CheckIdle(const std::string& parameters) {
  return Parameters("idle", parameters).Finish();
}

Result<std::unique_ptr<Controller>> CreateIdle(const RobotInfo& info) {
  if (Status status = CheckIdle(info.parameters); !status.ok()) return status.error();
  return std::unique_ptr<Controller>(std::make_unique<IdleController>());
}

}  // namespace

BuiltInController Idle() {
  return {"idle", CheckIdle, CreateIdle};
}

}  // namespace troupe
