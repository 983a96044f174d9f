// idle: stands still.
#include "robot-agent/controller/built_in.h"
#include "robot-agent/controller/parameters.h"

namespace troupe {
namespace {

class IdleController final : public Controller {
 public:
  Command Update(const Observation&) override { return {}; }
};

std::string CheckIdle(const std::string& parameters) {
  return Parameters("idle", parameters).Finish();
}

Result<std::unique_ptr<Controller>> CreateIdle(const RobotInfo& info) {
  if (const std::string error = CheckIdle(info.parameters); !error.empty()) return Error{{}, error};
  return std::unique_ptr<Controller>(std::make_unique<IdleController>());
}

}  // namespace

BuiltInController Idle() {
  return {"idle", CheckIdle, CreateIdle};
}

}  // namespace troupe
