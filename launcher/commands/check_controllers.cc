#include "launcher/commands/check_controllers.h"

#include "common/worldfile/scenario/scenario.h"
#include "robot-agent/controller/create_controller.h"

namespace troupe {

Status CheckControllers(const std::string& file, const std::optional<std::string>& controller) {
  if (controller) {
    if (const Status status = CheckController(*controller, "{}"); !status.ok()) {
      return Error{{}, "option --controller: " + status.error().message};
    }
  }
  if (!file.ends_with(".json")) return Status();
  LoadOverrides overrides;
  overrides.check_controller = CheckController;
  return CheckScenario(file, overrides);
}

}  // namespace troupe
